// How much memory the server may take, and for what.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"

namespace graspdb::server {

// Bytes. What is left of the total is for the calls that run, the views and the database.
struct MemoryShares {
  std::size_t total = 0;
  std::size_t caches = 0;    // models and clouds
  std::size_t requests = 0;  // read and not answered yet
};

// Half of `total_mib` for caches, or `cache_mib` where that is not 0, and a quarter for requests.
// With a total of 0 half of what the machine, or the control group of this process, has.
MemoryShares ShareMemory(int total_mib, int cache_mib);

// What this process has in memory, bytes; 0 where the system does not say.
std::size_t ResidentBytes();

// Counts requests in memory. Thread-safe.
class RequestMemory {
 public:
  struct Use {
    std::size_t bytes = 0;
    std::int64_t refused = 0;
  };

  // Gives its bytes back when it goes.
  class Reservation {
   public:
    Reservation(RequestMemory* memory, std::size_t bytes) : memory_(memory), bytes_(bytes) {}
    ~Reservation();
    Reservation(Reservation&& other) noexcept
        : memory_(std::exchange(other.memory_, nullptr)), bytes_(other.bytes_) {}
    Reservation& operator=(Reservation&&) = delete;

   private:
    RequestMemory* memory_;
    std::size_t bytes_;
  };

  explicit RequestMemory(std::size_t byte_budget) : budget_(byte_budget) {}

  // For a request that has so many bytes on the wire: its message, the points that are unpacked of
  // it, and those in the region of interest are in memory at once.
  static constexpr std::size_t kBytesPerWireByte = 3;

  // RESOURCE_EXHAUSTED, with the time after which to try again, when there is no room for `bytes`
  // more. A quarter of the budget is left for requests that take less than a sixteenth of it, as
  // robots' frames do: large ones cannot keep them out. Of requests that are larger than the rest
  // one goes in at a time.
  absl::StatusOr<Reservation> Reserve(std::size_t bytes);

  Use use() const;

 private:
  static constexpr std::size_t kSmallShare = 4;
  static constexpr std::size_t kSmall = 16;

  bool IsLarge(std::size_t bytes) const { return bytes > budget_ / kSmall; }
  bool HasRoom(std::size_t bytes) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // What large requests take of the small ones' quarter, bytes.
  std::size_t Overdraft() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::size_t budget_;
  mutable absl::Mutex mutex_;
  Use use_ ABSL_GUARDED_BY(mutex_);
  std::size_t large_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace graspdb::server
