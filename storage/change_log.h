// The one door through which the catalogue changes: numbers the changes, makes them
// durable, tells the listener. Internal to storage/.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "storage/change_batch.h"
#include "storage/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Safe from any thread.
class ChangeLog {
 public:
  using Clock = std::function<absl::Time()>;
  using Listener = std::function<void(const ChangeRecord&)>;

  // `database` must outlive the log. `meta` is what the database holds. `keep` (at least 1) change
  // records stay.
  ChangeLog(Database& database, MetaRecord meta, std::int64_t keep, Clock clock);

  // Lets `fill` put changes into a batch and commits it: all of it, durably, with the
  // listener told, or nothing. One mutation at a time: `fill` may read the database
  // and rely on what it reads. An error of `fill`, or a batch without a change,
  // changes nothing. FAILED_PRECONDITION from within the listener. After a write has
  // failed, what is on the disk is uncertain: all further mutations get UNAVAILABLE. A
  // listener that throws has missed that change, which stands, and is told of the next.
  absl::Status Mutate(absl::FunctionRef<absl::Status(ChangeBatch&)> fill)
      ABSL_LOCKS_EXCLUDED(writer_mutex_, meta_mutex_);

  // Sets the listener (empty: none) and returns the last revision it is not told of.
  absl::StatusOr<std::int64_t> Subscribe(Listener listener)
      ABSL_LOCKS_EXCLUDED(writer_mutex_, meta_mutex_);

  // Where the catalogue stands; never waits for a disk.
  MetaRecord meta() const ABSL_LOCKS_EXCLUDED(meta_mutex_);

  // Change records after a revision, oldest first, at most `limit`; OUT_OF_RANGE where some are no
  // longer kept.
  absl::StatusOr<std::vector<ChangeRecord>> Read(std::int64_t after_revision,
                                                 std::size_t limit) const;

 private:
  absl::Status Commit(ChangeBatch& batch) ABSL_EXCLUSIVE_LOCKS_REQUIRED(writer_mutex_);
  void Notify(const std::vector<ChangeRecord>& changes)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(writer_mutex_);
  void RaiseFloor(std::int64_t revision) ABSL_EXCLUSIVE_LOCKS_REQUIRED(writer_mutex_);
  absl::Status CheckNotInListener() const;

  Database& database_;
  const std::int64_t keep_;
  const Clock clock_;

  absl::Mutex writer_mutex_ ABSL_ACQUIRED_BEFORE(meta_mutex_);
  Listener listener_ ABSL_GUARDED_BY(writer_mutex_);
  absl::Status failure_ ABSL_GUARDED_BY(writer_mutex_);
  std::int64_t floor_ ABSL_GUARDED_BY(writer_mutex_);
  std::atomic<std::thread::id> notifying_thread_;

  mutable absl::Mutex meta_mutex_;
  MetaRecord meta_ ABSL_GUARDED_BY(meta_mutex_);
};

}  // namespace graspdb::storage
