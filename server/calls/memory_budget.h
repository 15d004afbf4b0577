// Memory limits of the server.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"

namespace graspdb::server {

// Bytes. The rest of the total is for running calls, the views and the database.
struct MemoryShares {
  std::size_t total = 0;
  std::size_t caches = 0;    // models and clouds
  std::size_t requests = 0;  // read and still in progress
};

// Half of `total_mib` for caches, or `cache_mib` if not 0, and a quarter for requests. A total of 0
// means half the memory of the machine, or of the control group of this process.
MemoryShares ShareMemory(int total_mib, int cache_mib);

// Resident memory of this process, bytes; 0 if the system does not report it.
std::size_t ResidentBytes();

// Counts requests in memory. Thread-safe.
class RequestMemory {
 public:
  struct Use {
    std::size_t bytes = 0;
    std::int64_t refused = 0;
  };

  // Releases its bytes when destroyed.
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

  explicit RequestMemory(std::size_t byte_budget);

  // Memory of a request per byte on the wire: its message, the points unpacked from it, and those
  // in the region of interest are in memory at once.
  static constexpr std::size_t kBytesPerWireByte = 3;

  // RESOURCE_EXHAUSTED, with RetryInfo, when `bytes` more exceed the budget. Requests of up to a
  // sixteenth of the budget, such as depth images, have a pool of their own, a quarter of it, so
  // that large requests cannot displace them; larger ones share the rest. A request that is larger
  // than its pool is admitted while no other request of that pool is in memory.
  absl::StatusOr<Reservation> Reserve(std::size_t bytes);

  Use use() const;

 private:
  // Shares of the budget. At --memory-mib 256 requests of up to 1.4 MB on the wire are small, three
  // depth images of a Kinect v2.
  static constexpr std::size_t kSmallShare = 16;
  static constexpr std::size_t kSmallPoolShare = 4;

  struct Pool {
    std::size_t budget = 0;  // bytes
    std::size_t bytes = 0;   // in memory
  };
  Pool& PoolFor(std::size_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return bytes <= max_small_ ? small_ : large_;
  }

  const std::size_t max_small_;  // bytes of one request
  mutable absl::Mutex mutex_;
  Pool small_ ABSL_GUARDED_BY(mutex_);
  Pool large_ ABSL_GUARDED_BY(mutex_);
  std::int64_t refused_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace graspdb::server
