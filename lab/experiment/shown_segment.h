// The segment of a trial's object.
#pragma once

#include "absl/status/statusor.h"
#include "lab/experiment/trial.h"
#include "recognition/recognizer.h"

namespace graspdb::lab {

struct ShownSegment {
  recognition::Segment segment;
  recognition::Pose world_sensor = recognition::Pose::Identity();  // T_world_sensor
  recognition::WorldFrame world_frame = recognition::WorldFrame::kGiven;
};

// The segment of the trial's first object. FAILED_PRECONDITION if it is not visible; errors as
// SegmentScan.
absl::StatusOr<ShownSegment> SegmentShown(const Trial& trial,
                                          const recognition::RecognitionParameters& parameters);

}  // namespace graspdb::lab
