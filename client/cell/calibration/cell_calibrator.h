// The cameras that robots may calibrate.
#pragma once

#include <map>
#include <memory>

#include "client/cell/calibration/hand_eye_session.h"
#include "client/cell/robots/robot_calibrator.h"

namespace graspdb::client {

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
