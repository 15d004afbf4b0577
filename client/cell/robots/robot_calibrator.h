// Hand-eye calibration by robots, independent of the protocol.
#pragma once

#include <cstddef>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// Residuals of a calibration.
struct CalibrationReport {
  double shift_m = 0;  // root mean square over the poses used
  double turn_rad = 0;
  std::size_t used = 0;   // poses that agree with the others
  std::size_t poses = 0;  // number of poses set
};

// Calibrates cameras, each a pipeline with a number. Implementations are thread-safe; the state
// belongs to the pipeline, not to the robot's connection.
//
// Errors of all but Check: FAILED_PRECONDITION when the cell or the target is not set up correctly;
// UNAVAILABLE when the server is unavailable; DATA_LOSS when the camera gives no frame that can be
// used; DEADLINE_EXCEEDED; ABORTED when Init was not called; others for other failures. Error
// messages contain the next step.
class RobotCalibrator {
 public:
  virtual ~RobotCalibrator() = default;

  // NOT_FOUND when there is no such pipeline.
  virtual absl::Status Check(int pipeline) = 0;

  // Starts a new calibration; discards the previous poses.
  virtual absl::Status Init(int pipeline) = 0;

  // Detects the target while the robot stands still at T_base_flange. Replaces the slot, but only
  // if the target is found. NOT_FOUND when it is not.
  virtual absl::Status SetPose(int pipeline, int slot, const recognition::Pose& base_flange) = 0;

  // Solves and saves. NOT_FOUND when the poses are too few, too similar or inconsistent.
  virtual absl::StatusOr<CalibrationReport> Calibrate(int pipeline) = 0;
};

}  // namespace graspdb::client
