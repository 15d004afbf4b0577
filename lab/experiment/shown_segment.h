// What is seen of the object that a trial is about.
#pragma once

#include "absl/status/statusor.h"
#include "lab/experiment/trial.h"
#include "recognition/recognizer.h"

namespace graspdb::client {

struct ShownSegment {
  recognition::Segment segment;
  recognition::Pose world_sensor = recognition::Pose::Identity();  // T_world_sensor
  recognition::WorldFrame world_frame = recognition::WorldFrame::kGiven;
};

// The segment of the trial's first object. FAILED_PRECONDITION where nothing is seen of it; errors
// as SegmentScan.
absl::StatusOr<ShownSegment> SegmentShown(const Trial& trial,
                                          const recognition::RecognitionParameters& parameters);

}  // namespace graspdb::client
