// Metrics of events: calls, frames, picks.
#pragma once

#include <grpcpp/support/status.h>

#include <string>
#include <string_view>

#include "absl/time/time.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "program/metrics/families.h"

namespace graspdb::server {

// Counts since the start. Thread-safe.
class CallMetrics {
 public:
  void CountCall(std::string_view method, const grpc::Status& status, absl::Duration time);

  // `response` has timings. `waited`: in the queue.
  void CountFrame(const std::string& cell, const v1::RecognizeResponse& response,
                  absl::Duration waited);

  // `cell`: empty if unknown.
  void CountPicks(const std::string& cell, const v1::ReportGraspOutcomeRequest& request);

  MetricFamilies Collect() const;

 private:
  CounterFamily calls_{"graspdb_calls_total", "Calls that ended.", {"method", "code"}};
  CounterFamily rejected_{"graspdb_rejected_calls_total",
                          "Calls that ended with an error, by the reason in its details.",
                          {"reason"}};
  HistogramFamily call_times_{"graspdb_call_duration_seconds",
                              "Time from the start of a handler to its end; a stream's is as long "
                              "as its client keeps it open.",
                              {"method"},
                              DurationBounds()};
  HistogramFamily step_times_{"graspdb_frame_step_duration_seconds",
                              "Time of a frame's steps: queue, decode, segment, describe, match, "
                              "register.",
                              {"step"},
                              DurationBounds()};
  CounterFamily frames_{
      "graspdb_frames_total", "Frames that were processed, by status.", {"cell", "status"}};
  CounterFamily detections_{
      "graspdb_detections_total",
      "Detections in frames, by status; the share of UNKNOWN_OBJECT is the unknown rate.",
      {"cell", "status"}};
  CounterFamily unknown_{"graspdb_unknown_objects_total",
                         "Detections that are UNKNOWN_OBJECT, by the evidence against the best "
                         "hypothesis.",
                         {"gate"}};
  HistogramFamily scores_{"graspdb_detection_score",
                          "Confidence of the detections with an object, 0 to 1.",
                          {},
                          {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 1}};
  CounterFamily picks_{
      "graspdb_picks_total", "Reported outcomes of grasps.", {"cell", "object", "outcome"}};
};

}  // namespace graspdb::server
