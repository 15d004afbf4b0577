// The hand-eye calibration of cameras, pose by pose.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/calibration/hand_eye.h"
#include "client/cell/calibration/target/target.h"
#include "client/cell/robots/job_runner.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/sdk/client.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// The region in which a gripper must hold the target: up to `half_width_m` from the world's z axis
// along x and y, and 6 to 50 cm above the table; world frame, m. A smaller region with fewer other
// objects gives a faster search and fewer false detections.
inline recognition::Box GrippedRegion(double half_width_m) {
  return {{-half_width_m, -half_width_m, 0.06}, {half_width_m, half_width_m, 0.5}};
}

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

// Sessions by the number of their pipeline. Thread-safe once all are added.
class CellCalibrator : public RobotCalibrator {
 public:
  // Replaces a session with the same number.
  void Add(int pipeline, std::unique_ptr<HandEyeSession> session);

  absl::Status Check(int pipeline) override;
  absl::Status Init(int pipeline) override;
  absl::Status SetPose(int pipeline, int slot, const recognition::Pose& base_flange) override;
  absl::StatusOr<CalibrationReport> Calibrate(int pipeline) override;

 private:
  absl::StatusOr<HandEyeSession*> SessionOf(int pipeline) const;

  std::map<int, std::unique_ptr<HandEyeSession>> sessions_;
};

}  // namespace graspdb::client
