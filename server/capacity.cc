#include "server/capacity.h"

#include <algorithm>
#include <cstddef>
#include <thread>

namespace graspdb::server {
namespace {

// Minimum and maximum number of threads for calls, whatever the memory.
constexpr int kMinThreads = 16;
constexpr std::size_t kMaxThreads = 256;

}  // namespace

int WorkersOf(const ServerOptions& options) {
  if (options.workers > 0) return options.workers;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int QueueOf(const ServerOptions& options) {
  return options.queue.value_or(std::max(2, WorkersOf(options)));
}

int ThreadsFor(const MemoryShares& memory, const ServerOptions& options) {
  const std::size_t max_message = static_cast<std::size_t>(options.max_message_mib) << 20U;
  const std::size_t fit = memory.requests / max_message;
  const int least = kMinThreads + 2 * WorkersOf(options);
  return std::max(least, static_cast<int>(std::min<std::size_t>(fit, kMaxThreads)));
}

}  // namespace graspdb::server
