// The hand-eye calibration of one camera, pose by pose.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/calibration/hand_eye.h"
#include "client/cell/calibration/target.h"
#include "client/cell/robots/robot_calibrator.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// What to calibrate, and the target.
struct HandEyeSetup {
  std::string cell;    // `cells/{cell}`
  std::string target;  // as LoadTarget takes it
  CameraMount mount = CameraMount::kFixed;
  int frames = 5;  // averaged at each pose
  // Region of the gripped target of a fixed camera, world frame, m; see FindGrippedTarget.
  std::optional<recognition::Box> region = {};
};

// Thread-safe; calls are serialized. Errors as RobotCalibrator.
class HandEyeSession {
 public:
  // `client` and `sensor` must outlive it.
  HandEyeSession(Client& client, DepthSensor& sensor, HandEyeSetup setup);

  // Reads the cell and the target from the server, and discards all poses.
  absl::Status Init() ABSL_LOCKS_EXCLUDED(mutex_);

  // Detects the target while the robot is at `base_flange`. `slot`: any number.
  absl::Status SetPose(int slot, const recognition::Pose& base_flange) ABSL_LOCKS_EXCLUDED(mutex_);

  // Solves, and updates the cell, see CalibratedCell. Logs the residual of every pose.
  absl::StatusOr<CalibrationReport> Calibrate() ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  absl::StatusOr<DetectedTarget> DetectTarget() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  Client& client_;
  DepthSensor& sensor_;
  const HandEyeSetup setup_;
  absl::Mutex mutex_;
  std::optional<Target> target_ ABSL_GUARDED_BY(mutex_);  // after Init
  recognition::Pose world_sensor_ ABSL_GUARDED_BY(mutex_) = recognition::Pose::Identity();
  std::map<int, HandEyeSample> samples_ ABSL_GUARDED_BY(mutex_);  // by slot
};

}  // namespace graspdb::client
