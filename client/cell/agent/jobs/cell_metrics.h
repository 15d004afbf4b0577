// What a cell's agent counts: counters for its log, and metrics.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "client/cell/agent/jobs/cell_runner.h"
#include "client/cell/blackbox/black_box.h"
#include "client/cell/robots/job_runner.h"
#include "graspdb/v1/catalog.pb.h"
#include "program/base/latency_histogram.h"
#include "program/base/monotonic_time.h"
#include "program/base/stop_flag.h"
#include "program/metrics/families.h"

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

// Read when the metrics are collected.
struct CellState {
  bool is_camera_ready = false;
  bool is_server_ready = false;
  std::size_t gri_connections = 0;
  std::size_t line_connections = 0;
  BlackBoxCounts bundles = {};
};

// Counts since the start. Thread-safe.
class CellMetrics {
 public:
  // The resource name of the cell, a label of all metrics.
  explicit CellMetrics(std::string cell) : cell_(std::move(cell)) {}

  void CountJob(const JobReport& report);
  void CountPick(const std::string& object, v1::GraspOutcome outcome);

  MetricFamilies Collect(const CellState& state) const;

 private:
  const std::string cell_;
  CounterFamily jobs_{"graspdb_cell_jobs_total",
                      "Recognising jobs of robots, by the code of their result.",
                      {"cell", "job", "code"}};
  CounterFamily empty_jobs_{"graspdb_cell_empty_jobs_total",
                            "Recognising jobs with the code OK but without a pose.",
                            {"cell", "job"}};
  HistogramFamily job_times_{"graspdb_cell_job_duration_seconds",
                             "Time from the request of a robot to the poses.",
                             {"cell"},
                             DurationBounds()};
  HistogramFamily camera_times_{"graspdb_cell_camera_wait_seconds",
                                "Part of a job's time that is spent waiting for the frame.",
                                {"cell"},
                                DurationBounds()};
  CounterFamily picks_{"graspdb_cell_picks_total",
                       "Outcomes of grasps that robots reported.",
                       {"cell", "object", "outcome"}};
  mutable absl::Mutex mutex_;
  // Of the newest frame.
  MonotonicTime frame_time_ ABSL_GUARDED_BY(mutex_) = MonotonicTime::InfinitePast();
};

}  // namespace graspdb::client
