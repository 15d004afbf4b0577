// The hand-eye calibration actions of the Generic Robot Interface.
#pragma once

#include "client/cell/robots/gri_message.h"
#include "client/cell/robots/robot_calibrator.h"

namespace graspdb::client {

// The last slot: the documentation has 0 to 7, robot programs send 1 to 8.
inline constexpr int kLastHecSlot = 8;

// Answers HEC_INIT, HEC_SET_POSE and HEC_CALIBRATE; data_1 of the request is the pipeline, data_2
// of HEC_SET_POSE the slot. The answer to HEC_CALIBRATE has the root mean square residuals: data_2
// the shift in 10^-6 mm, data_3 the turn in 10^-6 degrees, data_4 the number of poses used. Error
// messages are logged. Thread-safe.
class GriHandEye {
 public:
  // `calibrator` must outlive this; null: no pipelines.
  explicit GriHandEye(RobotCalibrator* calibrator) : calibrator_(calibrator) {}

  // The header must have been checked.
  GriResponse Answer(const GriRequest& request);

 private:
  absl::Status Do(const GriRequest& request, GriResponse* out);

  RobotCalibrator* calibrator_;
};

}  // namespace graspdb::client
