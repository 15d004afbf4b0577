// How many calls a server processes, queues and accepts.
#pragma once

#include <grpcpp/server_builder.h>

#include <memory>

#include "program/connections/connection_watch.h"
#include "server/base/options.h"
#include "server/calls/call_places.h"
#include "server/calls/memory_budget.h"

namespace graspdb::server {

// Scans that are processed at the same time; by default one on each core.
int WorkersOf(const ServerOptions& options);

// Scans that wait for a worker; by default one for each of them. A waiting frame takes as long as
// the one before it, twice as long as one that is alone. Doubled, it takes three times as long
// (docs/reliability.md).
int QueueOf(const ServerOptions& options);

// Calls that may be in progress, unary ones and streams: all that wait for a worker, and others
// beside them. What they hold in memory is bounded by the memory for requests, not by their number:
// gRPC reads messages within its quota, and a message that was parsed is charged or refused at
// once.
CallPlaces::Limits PlacesFor(const ServerOptions& options);

// The server to be built has this memory for incomplete messages, and threads for calls: one for
// each place, and some for calls that are refused, so that gRPC does not refuse calls itself, which
// it does without RetryInfo.
void LimitCalls(const MemoryShares& memory, const ServerOptions& options,
                grpc::ServerBuilder& builder);

// Ends connections that take memory beyond these shares by what gRPC does not limit.
std::unique_ptr<ConnectionWatch> WatchConnections(const MemoryShares& memory,
                                                  const ServerOptions& options);

}  // namespace graspdb::server
