// Sends requests to a server repeatedly and measures.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "program/base/latency_histogram.h"

namespace graspdb::lab {

// Time stamps of one request.
struct RequestTimes {
  using Time = std::chrono::steady_clock::time_point;
  Time due;       // when it should have been sent
  Time sent;      // when it was sent
  Time finished;  // when its answer or error arrived
};

// The step between when a request is due and when it is sent.
inline constexpr char kBeforeSending[] = "before sending";

// A part of the time between a request and its answer.
struct Step {
  std::string name;
  // Whether it is part of the server's time.
  bool in_server = false;
  LatencyHistogram times;  // of the answers that had this step
};

// Requests that ended with one error code.
struct FailedRequests {
  std::int64_t count = 0;
  std::string example;                  // the message of one of them
  std::chrono::nanoseconds longest{0};  // from when it was due to its error
};

// Requests and their results. Not thread-safe: use one per thread and merge.
class Tally {
 public:
  void AddAnswer(const RequestTimes& times, const v1::RecognizeResponse& response);
  void AddError(const RequestTimes& times, const absl::Status& status);
  void Merge(const Tally& other);

  // From when a request was due to its answer; of those that were answered.
  const LatencyHistogram& latency() const { return latency_; }
  // From when a request was due to when it was sent; of all.
  const LatencyHistogram& lateness() const { return lateness_; }
  // Answers by the name of their status, e.g. "OK", "UNKNOWN_OBJECT".
  const std::map<std::string, std::int64_t>& outcomes() const { return outcomes_; }
  const std::map<absl::StatusCode, FailedRequests>& errors() const { return errors_; }
  // Steps of the answered requests, in order: before sending, network and queue, the server in
  // total, and then the steps that the server reports.
  const std::vector<Step>& steps() const { return steps_; }

  std::int64_t answered() const { return latency_.count(); }
  std::int64_t failed() const { return lateness_.count() - latency_.count(); }

 private:
  Step& StepNamed(const std::string& name, bool in_server);

  LatencyHistogram latency_;
  LatencyHistogram lateness_;
  std::map<std::string, std::int64_t> outcomes_;
  std::map<absl::StatusCode, FailedRequests> errors_;
  std::vector<Step> steps_;
};

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
