// Sends requests to a server repeatedly and measures.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

#include "absl/status/statusor.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "lab/load/tally.h"

namespace graspdb::lab {

// Rate and length of a run. At least one of `requests` and `duration` is set; the run ends at the
// first limit.
struct LoadPlan {
  // Maximum number of requests in flight. Without a rate always this many: each worker sends the
  // next request as soon as it has its answer (a closed loop).
  int concurrency = 1;
  // Requests a second, evenly spaced; 0: none. With a rate, request n is due n / rate seconds after
  // the start, whatever the state of earlier requests (an open loop), and its latency counts from
  // then, so that it includes the wait for a worker.
  double rate = 0;
  std::int64_t requests = 0;             // 0: any number
  std::chrono::nanoseconds duration{0};  // 0: any time
};

// Sends request number `request` from worker number `worker`, both from 0; called concurrently by
// all workers.
using SendRequest =
    std::function<absl::StatusOr<v1::RecognizeResponse>(int worker, std::int64_t request)>;

// Both are called periodically by the thread that called RunLoad.
struct LoadWatch {
  std::function<void(std::int64_t requests, std::chrono::nanoseconds elapsed)> report;
  std::function<bool()> cancelled;
};

struct LoadResult {
  Tally tally;
  std::chrono::nanoseconds elapsed{0};  // from the start to the last answer
  // With a rate: requests that were due but not sent when the last one was sent.
  std::int64_t backlog = 0;
  bool cancelled = false;

  double RequestsPerSecond() const;  // that were answered
};

// Whether requests were sent at the planned rate, except for 2 % or two of them.
bool KeptRate(const LoadPlan& plan, const LoadResult& result);

// Runs until the plan is complete or `watch` cancels, then waits for requests in flight. In a
// closed loop a worker that finds no server pauses a tenth of a second; otherwise most counted
// requests would be its errors.
LoadResult RunLoad(const LoadPlan& plan, const SendRequest& send, const LoadWatch& watch);

}  // namespace graspdb::lab
