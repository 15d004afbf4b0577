#include "client/cell/agent/jobs/cell_metrics.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "program/log/background_log.h"
#include "program/version.h"

namespace graspdb::client {

void Counters::CountJob(const absl::Status& status, std::size_t poses,
                        absl::Duration beside_camera) {
  absl::MutexLock lock(&mutex_);
  ++jobs_;
  if (!status.ok()) {
    ++errors_[absl::AsciiStrToLower(absl::StatusCodeToString(status.code()))];
    return;
  }
  if (poses > 0) ++with_pose_;
  times_.Record(absl::ToChronoNanoseconds(beside_camera));
}

void Counters::CountOutcome(PickOutcome outcome) {
  absl::MutexLock lock(&mutex_);
  ++outcomes_[static_cast<std::size_t>(outcome)];
}

std::string Counters::Text() const {
  absl::MutexLock lock(&mutex_);
  const auto milliseconds = [](LatencyHistogram::Duration time) {
    return std::chrono::duration<double, std::milli>(time).count();
  };
  std::string out =
      absl::StrFormat("jobs=%d with_pose=%d p50_ms=%.2f p99_ms=%.2f", jobs_, with_pose_,
                      milliseconds(times_.Percentile(50)), milliseconds(times_.Percentile(99)));
  for (const auto& [code, count] : errors_) absl::StrAppend(&out, " error_", code, "=", count);
  absl::StrAppend(&out, " picked=", outcomes_[0], " missed=", outcomes_[1],
                  " slipped=", outcomes_[2]);
  return out;
}

CountersLog::CountersLog(std::function<std::string()> text, absl::Duration period)
    : text_(std::move(text)), period_(period), thread_([this] { Run(); }) {}

CountersLog::~CountersLog() {
  stop_.Raise();
  thread_.join();
}

void CountersLog::Run() {
  for (bool last = false; !last;) {
    last = stop_.Wait(absl::ToChronoNanoseconds(period_));
    spdlog::info("event=counters {}", text_());
  }
}

void CellMetrics::CountJob(const JobReport& report) {
  const std::string job = absl::StrCat(report.request.job);
  jobs_.With({cell_, job, absl::StatusCodeToString(report.status.code())}).Increment();
  prometheus::Counter& empty_jobs = empty_jobs_.With({cell_, job});  // at 0 before the first one
  if (report.status.ok() && report.poses.empty()) empty_jobs.Increment();
  job_times_.With({cell_}).Observe(absl::ToDoubleSeconds(report.duration));
  camera_times_.With({cell_}).Observe(absl::ToDoubleSeconds(report.capture.camera_time));
  absl::MutexLock lock(&mutex_);
  frame_time_ = std::max(frame_time_, report.capture.frame_time);
}

void CellMetrics::CountPick(const std::string& object, v1::GraspOutcome outcome) {
  for (const v1::GraspOutcome each :
       {v1::GRASP_OUTCOME_PICKED, v1::GRASP_OUTCOME_MISSED, v1::GRASP_OUTCOME_SLIPPED}) {
    picks_.With({cell_, object, v1::GraspOutcome_Name(each)});  // at 0 before the first one
  }
  picks_.With({cell_, object, v1::GraspOutcome_Name(outcome)}).Increment();
}

MetricFamilies CellMetrics::Collect(const CellState& state) const {
  const auto sample = [&](auto value, const char* label = nullptr, const char* text = "") {
    Sample out{static_cast<double>(value), {{"cell", cell_}}};
    if (label != nullptr) out.labels.push_back({label, text});
    return out;
  };
  std::vector<Sample> age;
  {
    absl::MutexLock lock(&mutex_);
    if (frame_time_ != MonotonicTime::InfinitePast()) {
      age.push_back(sample(absl::ToDoubleSeconds(MonotonicTime::Now() - frame_time_)));
    }
  }
  return {GaugeOf("graspdb_build_info", "1, with the version of the program.",
                  {{1, {{"version", kVersion}}}}),
          GaugeOf("graspdb_cell_camera_ready", "1 while the camera delivers frames, else 0.",
                  {sample(state.is_camera_ready)}),
          GaugeOf("graspdb_cell_frame_age_seconds",
                  "Age of the newest frame that a job used; none before the first one.",
                  std::move(age)),
          GaugeOf("graspdb_cell_server_ready",
                  "1 if the last periodic read of the cell's calibration succeeded, else 0.",
                  {sample(state.is_server_ready)}),
          GaugeOf("graspdb_cell_robot_connections", "Open connections of robots.",
                  {sample(state.gri_connections, "protocol", "gri"),
                   sample(state.line_connections, "protocol", "line")}),
          CounterOf("graspdb_cell_bundles_total", "Bundles of the black box.",
                    {sample(state.bundles.kept, "result", "kept"),
                     sample(state.bundles.dropped, "result", "dropped"),
                     sample(state.bundles.failed, "result", "failed")}),
          CounterOf("graspdb_cell_log_lost_lines_total",
                    "Lines of the log that were lost, as its reader did not read.",
                    {sample(LostLogLines())}),
          jobs_.Collect(),
          empty_jobs_.Collect(),
          job_times_.Collect(),
          camera_times_.Collect(),
          picks_.Collect()};
}

}  // namespace graspdb::client
