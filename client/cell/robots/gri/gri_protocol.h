// The Generic Robot Interface for RobotServer.
#pragma once

#include "client/cell/robots/gri/gri_hand_eye.h"
#include "client/cell/robots/gri/gri_jobs.h"
#include "client/cell/robots/robot_server.h"

namespace graspdb::client {

// Every message gets an answer of 80 bytes. Foreign bytes and wrong lengths close the connection,
// because the start of the next message is unknown.
class GriProtocol : public RobotProtocol {
 public:
  // `jobs` and `calibrator` must outlive this; null: no pipeline can be calibrated.
  explicit GriProtocol(GriJobs& jobs, RobotCalibrator* calibrator = nullptr)
      : jobs_(jobs), hand_eye_(calibrator) {}

  std::size_t MessageBytes(std::string_view received) const override;
  RobotReply Answer(const std::string& robot, std::string_view message) override;

 private:
  GriResponse Dispatch(const std::string& robot, const GriRequest& request);

  GriJobs& jobs_;
  GriHandEye hand_eye_;
};

}  // namespace graspdb::client
