// A server of its own for one test, taught a sample part from all around.
#pragma once

#include <memory>
#include <string>

#include "client/api/client.h"
#include "client/simulation/depth_camera.h"
#include "server/server.h"
#include "tests/client/files/temporary_folder.h"

namespace graspdb::testing {

class CalibrationServer {
 public:
  CalibrationServer();

  client::Client& client() { return *client_; }

  // Teaches `part` as this camera sees it from four look-down angles.
  void Teach(const std::string& part, const client::DepthCameraModel& camera);
  // Makes `cells/{id}`; without a sensor pose where there is none.
  void MakeCell(const std::string& id, const recognition::Pose* world_sensor);

 private:
  client::TemporaryFolder folder_;
  std::unique_ptr<server::Server> server_;
  std::unique_ptr<client::Client> client_;
};

}  // namespace graspdb::testing
