// Counts of a load test.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
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

}  // namespace graspdb::lab
