// Asks a server again and again, and measures.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

#include "absl/status/statusor.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "lab/load/tally.h"

namespace graspdb::client {

// What is asked, and how long. At least one of `requests` and `duration` is given; the run ends
// with the first.
struct LoadPlan {
  // Requests in flight, at most. Without a rate always so many: each worker asks again as soon as
  // it has its answer (a closed loop).
  int concurrency = 1;
  // Requests a second, evenly spaced; 0: none. With a rate, request n is due n / rate seconds after
  // the start whatever became of those before (an open loop), and its latency counts from then:
  // what waited for a worker was not answered any sooner by being asked late.
  double rate = 0;
  std::int64_t requests = 0;             // 0: any number
  std::chrono::nanoseconds duration{0};  // 0: any time
};

// Request number `n` from 0, by the worker with that number from 0; called by all workers at once.
using Ask = std::function<absl::StatusOr<v1::RecognizeResponse>(int worker, std::int64_t request)>;

// Both are called now and then by the thread that called RunLoad.
struct LoadWatch {
  std::function<void(std::int64_t requests, std::chrono::nanoseconds elapsed)> report;
  std::function<bool()> cancelled;
};

struct LoadResult {
  Tally tally;
  std::chrono::nanoseconds elapsed{0};  // from the start to the last answer
  // With a rate: requests that were due and not sent when the last one was.
  std::int64_t backlog = 0;
  bool cancelled = false;

  double RequestsPerSecond() const;  // that were answered
};

// Whether requests were sent as fast as the plan says, but for 2 % or two of them.
bool KeptRate(const LoadPlan& plan, const LoadResult& result);

// Runs until the plan is fulfilled or `watch` cancels; what is in flight then is waited for. In a
// closed loop a worker that finds no server pauses a tenth of a second, or its errors would be
// most of what is counted.
LoadResult RunLoad(const LoadPlan& plan, const Ask& ask, const LoadWatch& watch);

}  // namespace graspdb::client
