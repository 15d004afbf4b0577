// Metrics of a cell's agent.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/agent/jobs/cell_runner.h"
#include "client/cell/blackbox/black_box.h"
#include "graspdb/v1/catalog.pb.h"
#include "program/base/monotonic_time.h"
#include "program/metrics/families.h"

namespace graspdb::client {

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
