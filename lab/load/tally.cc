#include "lab/load/tally.h"

#include <algorithm>

namespace graspdb::lab {
namespace {

using std::chrono::nanoseconds;

nanoseconds FromMilliseconds(double ms) {
  return std::chrono::duration_cast<nanoseconds>(std::chrono::duration<double, std::milli>(ms));
}

}  // namespace

Step& Tally::StepNamed(const std::string& name, bool in_server) {
  const auto is_it = [&](const Step& s) { return s.name == name && s.in_server == in_server; };
  const auto found = std::find_if(steps_.begin(), steps_.end(), is_it);
  if (found != steps_.end()) return *found;
  return steps_.emplace_back(Step{name, in_server, {}});
}

void Tally::AddAnswer(const RequestTimes& times, const v1::RecognizeResponse& response) {
  latency_.Record(times.finished - times.due);
  lateness_.Record(times.sent - times.due);
  ++outcomes_[v1::RecognitionStatus_Name(response.status())];
  const nanoseconds server = FromMilliseconds(response.timings().total_ms());
  StepNamed(kBeforeSending, false).times.Record(times.sent - times.due);
  StepNamed("network and queue", false).times.Record(times.finished - times.sent - server);
  StepNamed("server in total", false).times.Record(server);
  const auto add = [&](const std::string& name, double ms) {
    const nanoseconds time = FromMilliseconds(ms);
    StepNamed(name, true).times.Record(time);
    return time;
  };
  nanoseconds named = add("decode", response.timings().decode_ms());
  for (const v1::StageReport& stage : response.stages()) {
    named += add(stage.stage(), stage.duration_ms());
  }
  StepNamed("rest", true).times.Record(server - named);
}

void Tally::AddError(const RequestTimes& times, const absl::Status& status) {
  lateness_.Record(times.sent - times.due);
  FailedRequests& failed = errors_[status.code()];
  if (failed.count++ == 0) failed.example = std::string(status.message());
  failed.longest = std::max<nanoseconds>(failed.longest, times.finished - times.due);
}

void Tally::Merge(const Tally& other) {
  latency_.Merge(other.latency_);
  lateness_.Merge(other.lateness_);
  for (const auto& [status, count] : other.outcomes_) outcomes_[status] += count;
  for (const auto& [code, failed] : other.errors_) {
    FailedRequests& mine = errors_[code];
    if (mine.count == 0) mine.example = failed.example;
    mine.count += failed.count;
    mine.longest = std::max(mine.longest, failed.longest);
  }
  for (const Step& step : other.steps_) {
    StepNamed(step.name, step.in_server).times.Merge(step.times);
  }
}

}  // namespace graspdb::lab
