// Hand-eye calibration as robots ask for it, whatever protocol they speak.
#pragma once

#include <cstddef>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// How well the poses of a calibration agree with it.
struct CalibrationReport {
  double shift_m = 0;  // root mean square over the poses that were used
  double turn_rad = 0;
  std::size_t used = 0;   // poses that agree with the others
  std::size_t poses = 0;  // that were set
};

// Calibrates cameras, each a pipeline with a number. Implementations are thread-safe; what is kept
// belongs to the pipeline, not to the robot's connection.
//
// Errors of all but Check: FAILED_PRECONDITION when the cell or the target cannot be used as they
// are set up; UNAVAILABLE when camera or server are not there; DEADLINE_EXCEEDED; others when
// something else is wrong, ABORTED among them when Init did not come before. Each says what to do.
class RobotCalibrator {
 public:
  virtual ~RobotCalibrator() = default;

  // NOT_FOUND when there is no such pipeline.
  virtual absl::Status Check(int pipeline) = 0;

  // Forgets the poses before and begins.
  virtual absl::Status Init(int pipeline) = 0;

  // The robot stands still at T_base_flange: looks at the target. A slot that was set is replaced,
  // and only when the target is found. NOT_FOUND when the target was not seen.
  virtual absl::Status SetPose(int pipeline, int slot, const recognition::Pose& base_flange) = 0;

  // Solves and saves. NOT_FOUND when the poses do not suffice: too few, too much alike, or in
  // disagreement.
  virtual absl::StatusOr<CalibrationReport> Calibrate(int pipeline) = 0;
};

}  // namespace graspdb::client
