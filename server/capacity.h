// How many calls a server processes, queues and accepts.
#pragma once

#include "server/memory_budget.h"
#include "server/options.h"

namespace graspdb::server {

// Scans that are processed at the same time; by default one on each core.
int WorkersOf(const ServerOptions& options);

// Scans that wait for a worker; by default one for each of them. A waiting frame takes as long as
// the one before it, twice as long as one that is alone. Doubled, it takes three times as long
// (docs/reliability.md).
int QueueOf(const ServerOptions& options);

// Number of threads for calls, each of which may have parsed a message of the maximum size, within
// the memory for requests; but enough for the workers, and for calls that wait or are idle streams.
int ThreadsFor(const MemoryShares& memory, const ServerOptions& options);

}  // namespace graspdb::server
