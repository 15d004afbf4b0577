// A line protocol whose jobs give poses that were set before.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <string>
#include <vector>

#include "client/cell/robots/line/line_protocol.h"
#include "tests/client/cell/robots/scripted_runner.h"

namespace graspdb::client {

// A tool that points down, turned by 30 degrees about the vertical.
inline recognition::Pose Down(double x_m) {
  recognition::Pose out = recognition::Pose::Identity();
  out.linear() = (Eigen::AngleAxisd(std::numbers::pi / 6, Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
  out.translation() << x_m, -0.2, 0.0125;
  return out;
}

inline JobPose Grasp(double x_m, const std::string& id) {
  JobPose out;
  out.base_primary = Down(x_m);
  out.object = "objects/bracket";
  out.stable_pose = "objects/bracket/stablePoses/flat";
  out.grasp.set_grasp_id(id);
  out.grasp.set_gripper_opening_m(0.04);
  out.grasp.set_approach_distance_m(0.1);
  out.grasp.set_retreat_distance_m(0.05);
  out.score = 0.93;
  return out;
}

class LineProtocolTest : public ::testing::Test {
 protected:
  LineProtocolTest() {
    JobPose first = Grasp(0.5, "side");
    first.base_related = {Down(0.6)};
    runner_.Set(7, std::vector<JobPose>{first, Grasp(0.55, "top")});
    runner_.Set(8, std::vector<JobPose>());
    runner_.Set(9, absl::UnavailableError("the server is gone"));
  }

  std::string Call(const std::string& line, const std::string& robot = "r") {
    return protocol_.Answer(robot, line + "\n").bytes;
  }

  ScriptedRunner runner_;
  LineProtocol protocol_{runner_};
};

}  // namespace graspdb::client
