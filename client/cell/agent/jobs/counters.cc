#include "client/cell/agent/jobs/counters.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

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

}  // namespace graspdb::client
