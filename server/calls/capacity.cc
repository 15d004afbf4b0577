#include "server/calls/capacity.h"

#include <grpcpp/resource_quota.h>

#include <algorithm>
#include <thread>

namespace graspdb::server {
namespace {

// Streams, and unary calls beside the frames. One that waits takes some 120 KB, most of it for its
// thread.
constexpr int kMinStreams = 256;
constexpr int kOtherCalls = 256;
// Threads for calls that are refused, each within a fraction of a millisecond.
constexpr int kRefusingThreads = 128;
// Minimum number of threads that wait for calls.
constexpr int kMinPollers = 8;
// Calls of one connection at once; more wait in the client.
constexpr int kCallsOfConnection = 128;

// What the process may take beyond its memory before connections are ended: one in so many of it.
constexpr std::size_t kMemorySpareShare = 4;

}  // namespace

int WorkersOf(const ServerOptions& options) {
  if (options.workers > 0) return options.workers;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int QueueOf(const ServerOptions& options) {
  return options.queue.value_or(std::max(2, WorkersOf(options)));
}

CallPlaces::Limits PlacesFor(const ServerOptions& options) {
  return {.streams = std::max(kMinStreams, 2 * WorkersOf(options)),
          .unary = kOtherCalls + 2 * (WorkersOf(options) + QueueOf(options))};
}

void LimitCalls(const MemoryShares& memory, const ServerOptions& options,
                grpc::ServerBuilder& builder) {
  // A thread that finds more pollers than this ends, and the next frame starts a new one.
  builder.SetSyncServerOption(grpc::ServerBuilder::SyncServerOption::MAX_POLLERS,
                              std::max(kMinPollers, 2 * WorkersOf(options)));
  const CallPlaces::Limits places = PlacesFor(options);
  // When its memory is exhausted, gRPC stops reading, and ends waiting calls.
  grpc::ResourceQuota quota("graspdb");
  quota.Resize(memory.requests);
  quota.SetMaxThreads(places.streams + places.unary + kRefusingThreads);
  builder.SetResourceQuota(quota);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kCallsOfConnection);
}

std::unique_ptr<ConnectionWatch> WatchConnections(const MemoryShares& memory,
                                                  const ServerOptions& options) {
  return std::make_unique<ConnectionWatch>(
      ConnectionWatch::Limits{.memory_bytes = memory.total + memory.total / kMemorySpareShare,
                              .message_bytes = static_cast<std::size_t>(options.max_message_mib)
                                               << 20U},
      ResidentBytes);
}

}  // namespace graspdb::server
