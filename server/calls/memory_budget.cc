#include "server/calls/memory_budget.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "absl/status/status.h"
#include "server/base/errors.h"

namespace graspdb::server {
namespace {

constexpr std::size_t kMebi = std::size_t{1} << 20U;

// Of a control group; no limit where there is none (version 2, then version 1).
std::size_t GroupLimit() {
  std::size_t out = std::numeric_limits<std::size_t>::max();
  for (const char* path :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream file(path);
    if (std::size_t limit = 0; file >> limit && limit > 0) out = std::min(out, limit);
  }
  return out;
}

std::size_t MachineBytes() {
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long size = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || size <= 0) return 2048 * kMebi;
  return std::min(static_cast<std::size_t>(pages) * static_cast<std::size_t>(size), GroupLimit());
}

}  // namespace

MemoryShares ShareMemory(int total_mib, int cache_mib) {
  MemoryShares out;
  out.total = total_mib > 0 ? static_cast<std::size_t>(total_mib) * kMebi : MachineBytes() / 2;
  out.caches = cache_mib > 0 ? static_cast<std::size_t>(cache_mib) * kMebi : out.total / 2;
  out.requests = out.total / 4;
  return out;
}

std::size_t ResidentBytes() {
  std::ifstream file("/proc/self/statm");
  std::size_t size = 0;
  std::size_t resident = 0;
  if (!(file >> size >> resident)) return 0;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

RequestMemory::Reservation::~Reservation() {
  if (memory_ == nullptr) return;
  absl::MutexLock lock(&memory_->mutex_);
  memory_->PoolFor(bytes_).bytes -= bytes_;
}

RequestMemory::RequestMemory(std::size_t byte_budget)
    : max_small_(byte_budget / kSmallShare),
      small_{byte_budget / kSmallPoolShare},
      large_{byte_budget - byte_budget / kSmallPoolShare} {}

absl::StatusOr<RequestMemory::Reservation> RequestMemory::Reserve(std::size_t bytes) {
  absl::MutexLock lock(&mutex_);
  Pool& pool = PoolFor(bytes);
  if (pool.bytes > 0 && bytes > pool.budget - std::min(pool.budget, pool.bytes)) {
    ++refused_;
    return TryAgainLater(WithReason(
        absl::ResourceExhaustedError("the server has no memory left for another request; try again "
                                     "a little later, or give it more with --memory-mib"),
        "MEMORY_FULL"));
  }
  pool.bytes += bytes;
  return Reservation(this, bytes);
}

RequestMemory::Use RequestMemory::use() const {
  absl::MutexLock lock(&mutex_);
  return {small_.bytes + large_.bytes, refused_};
}

}  // namespace graspdb::server
