// The hand-eye calibrations that a cell's robots may run.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/agent/jobs/cell_cache.h"
#include "client/cell/agent/settings/calibration_config.h"
#include "client/cell/calibration/hand_eye_session.h"
#include "client/cell/robots/job_runner.h"

namespace graspdb::client {

// Calibrates with the cell's camera and server; the next job uses the result. Thread-safe.
class Calibrations : public RobotCalibrator {
 public:
  // All references must outlive this.
  Calibrations(const std::vector<CalibrationConfig>& configs, Client& client, DepthSensor& sensor,
               CellCache& cell);

  absl::Status Check(int pipeline) override { return sessions_.Check(pipeline); }
  absl::Status Init(int pipeline) override { return sessions_.Init(pipeline); }
  absl::Status SetPose(int pipeline, int slot, const recognition::Pose& base_flange) override {
    return sessions_.SetPose(pipeline, slot, base_flange);
  }
  absl::StatusOr<CalibrationReport> Calibrate(int pipeline) override;

 private:
  CellCalibrator sessions_;
  CellCache& cell_;
};

}  // namespace graspdb::client
