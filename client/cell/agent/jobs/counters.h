// Counters of a cell's agent, and their lines in the log.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "client/cell/robots/job_runner.h"
#include "program/base/latency_histogram.h"
#include "program/base/stop_flag.h"

namespace graspdb::client {

// Job statistics since the start. Thread-safe.
class Counters {
 public:
  // `poses`: found by a successful job. `beside_camera`: its duration without the wait for the
  // camera's frame.
  void CountJob(const absl::Status& status, std::size_t poses, absl::Duration beside_camera);
  void CountOutcome(PickOutcome outcome);

  // All as `key=value`, for the log.
  std::string Text() const;

 private:
  mutable absl::Mutex mutex_;
  std::int64_t jobs_ ABSL_GUARDED_BY(mutex_) = 0;
  std::int64_t with_pose_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::string, std::int64_t> errors_ ABSL_GUARDED_BY(mutex_);  // by code
  std::array<std::int64_t, 3> outcomes_ ABSL_GUARDED_BY(mutex_) = {};   // by PickOutcome
  LatencyHistogram times_ ABSL_GUARDED_BY(mutex_);
};

// Logs `text` every `period`, and once more at destruction, on its own thread.
class CountersLog {
 public:
  CountersLog(std::function<std::string()> text, absl::Duration period);
  ~CountersLog();
  CountersLog(const CountersLog&) = delete;
  CountersLog& operator=(const CountersLog&) = delete;

 private:
  void Run();

  const std::function<std::string()> text_;
  const absl::Duration period_;
  StopFlag stop_;
  std::thread thread_;
};

}  // namespace graspdb::client
