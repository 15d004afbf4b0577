// A server of its own for one test, taught a sample part from all around.
#pragma once

#include <string>

#include "rendering/camera/depth_camera.h"
#include "tests/client/catalogue_server.h"

namespace graspdb::testing {

class CalibrationServer : public CatalogueServer {
 public:
  // Teaches `part` with this camera from four look-down angles.
  void Teach(const std::string& part, const rendering::DepthCameraModel& camera);
  // Creates `cells/{id}`; null: without a sensor pose.
  void MakeCell(const std::string& id, const recognition::Pose* world_sensor);
};

}  // namespace graspdb::testing
