// How many calls may be in progress, so that no caller shuts out the others.
//
// gRPC's threads are one for each call in progress, also for a stream whose client sends nothing
// and for a response that its client does not read. A call has a place from its start until gRPC
// has sent its end, and there are more threads than places: they never run out.
#pragma once

#include <grpcpp/server_context.h>

#include <chrono>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "program/log/log_interval.h"

namespace graspdb::server {

// Thread-safe.
class CallPlaces {
 public:
  struct Limits {
    int streams = 0;
    int unary = 0;
    std::chrono::milliseconds idle = std::chrono::minutes(1);  // see Take()
  };
  struct Caller {
    std::string name;  // of an identity, or an address
    bool is_identified = false;
  };
  enum class Kind { kUnary, kStream, kReflection };

  // Releases its place when destroyed. For one thread.
  class Place {
   public:
    ~Place();
    Place(Place&& other) noexcept
        : places_(std::exchange(other.places_, nullptr)),
          kind_(other.kind_),
          entry_(other.entry_) {}
    Place& operator=(Place&&) = delete;

    // A message of the client has arrived.
    void NoteUse();
    // The handler has ended: the call is not cancelled any more.
    void NoteEnd();
    // Whether it was cancelled since its client sent nothing.
    bool is_cancelled() const;

   private:
    friend class CallPlaces;
    struct Entry {
      Caller caller;
      grpc::ServerContextBase* context;  // null: not to be cancelled
      std::chrono::steady_clock::time_point last_use;
      bool is_cancelled = false;
    };
    Place(CallPlaces* places, Kind kind, std::list<Entry>::iterator entry)
        : places_(places), kind_(kind), entry_(entry) {}

    CallPlaces* places_;
    Kind kind_;
    std::list<Entry>::iterator entry_;
  };

  explicit CallPlaces(const Limits& limits);

  // A caller gets half of the places of a kind, all callers without identity three quarters.
  // Otherwise RESOURCE_EXHAUSTED with RetryInfo; of the streams in the way, the one whose client
  // has sent nothing for the longest time is then cancelled, if that is longer than the limit of
  // idle times. `context`: of a stream whose client sends messages, else null; valid until
  // NoteEnd().
  absl::StatusOr<Place> Take(Kind kind, Caller caller, grpc::ServerContextBase* context);
  // A place for a stream of server reflection. There are few; the oldest stream is cancelled for a
  // new one, so that whoever reads it once finds one, whatever others leave open.
  Place TakeForReflection(grpc::ServerContextBase& context);

  // Refusals since the last line of the log, if a line is due.
  std::optional<std::int64_t> CountRefusal() { return refusals_.Count(); }

  // Calls in progress, and how many may be.
  int used(Kind kind) const;
  int limit(Kind kind) const;

 private:
  using Entries = std::list<Place::Entry>;
  struct Group {
    int limit = 0;
    int anonymous = 0;
    Entries entries;                       // in the order of their start
    std::map<std::string, int> by_caller;  // without those that have none
  };

  const Group& GroupOf(Kind kind) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  Group& GroupOf(Kind kind) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  Place Add(Kind kind, Caller caller, grpc::ServerContextBase* context)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Remove(Kind kind, Entries::iterator entry) ABSL_LOCKS_EXCLUDED(mutex_);

  const std::chrono::milliseconds idle_;
  mutable absl::Mutex mutex_;
  Group unary_ ABSL_GUARDED_BY(mutex_);
  Group streams_ ABSL_GUARDED_BY(mutex_);
  Group reflection_ ABSL_GUARDED_BY(mutex_);
  LogInterval refusals_;
};

}  // namespace graspdb::server
