#include <gmock/gmock.h>

#include "files/messages/pose_message.h"
#include "lab/simulated_robot/pick_run.h"
#include "recognition/base/units.h"

namespace graspdb::lab {
namespace {

using recognition::Pose;

Pose TurnAboutZ(double turn_rad) {
  return Pose(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()));
}

class JudgePickTest : public ::testing::Test {
 protected:
  JudgePickTest() {
    parts_[0].object_id = "bar";
    parts_[0].grasps = {rendering::TopGrasp("end", {0.05, 0, 0.02}, 0, 0.05)};
    parts_[1].object_id = "nut";
    parts_[1].symmetry_order = 6;
    parts_[1].grasps = {rendering::TopGrasp("flat", {0.01, 0, 0.02}, 0, 0.05)};
    parts_[2].object_id = "shaft";
    parts_[2].symmetry_order = 0;
    parts_[2].grasps = {rendering::TopGrasp("rim", {0.02, 0, 0.1}, 0, 0.05)};
  }

  // The tool as taught for a part, with the object turned about its z axis and the tool then moved
  // in its own frame.
  Pose Tool(std::size_t part, double turn_rad, const Pose& moved = Pose::Identity()) const {
    return world_object_ * TurnAboutZ(turn_rad) *
           files::FromMessage(parts_[part].grasps[0].tcp_pose()) * moved;
  }

  PickError Judge(std::size_t part, const Pose& world_tcp) const {
    rendering::PlannedCapture scene;
    scene.placements = {{part, world_object_}};
    return JudgePick(parts_, scene, world_tcp);
  }

  std::vector<rendering::Workpiece> parts_{3};
  const Pose world_object_ = Pose(Eigen::Translation3d(0.1, -0.05, 0)) * TurnAboutZ(1);
};

TEST_F(JudgePickTest, AcceptsTheTaughtPose) {
  const PickError error = Judge(0, Tool(0, 0));
  EXPECT_EQ(error.object, "bar");
  EXPECT_EQ(error.grasp_id, "end");
  EXPECT_NEAR(error.shift_m, 0, 1e-9);
  EXPECT_NEAR(error.turn_rad, 0, 1e-6);
  EXPECT_TRUE(WouldHold(error));
}

TEST_F(JudgePickTest, HasLimitsOfThreeMillimetresAndTwoDegrees) {
  const auto shifted = [&](double metres) {
    return Judge(0, Tool(0, 0, Pose(Eigen::Translation3d(metres, 0, 0))));
  };
  EXPECT_TRUE(WouldHold(shifted(0.0029)));
  EXPECT_FALSE(WouldHold(shifted(0.0031)));
  const auto turned = [&](double degrees) {
    return Judge(0, Tool(0, 0, TurnAboutZ(degrees * recognition::kRadiansPerDegree)));
  };
  EXPECT_TRUE(WouldHold(turned(1.9)));
  EXPECT_FALSE(WouldHold(turned(2.1)));
}

TEST_F(JudgePickTest, AcceptsOnlyTurnsOfTheSymmetry) {
  EXPECT_TRUE(WouldHold(Judge(1, Tool(1, 120 * recognition::kRadiansPerDegree))));
  EXPECT_FALSE(WouldHold(Judge(1, Tool(1, 30 * recognition::kRadiansPerDegree))));
  EXPECT_FALSE(WouldHold(Judge(0, Tool(0, 60 * recognition::kRadiansPerDegree))));
  EXPECT_TRUE(WouldHold(Judge(2, Tool(2, 1.2345))));
}

TEST_F(JudgePickTest, ComparesToTheNearestObject) {
  rendering::PlannedCapture scene;
  scene.placements = {{1, Pose(Eigen::Translation3d(-0.2, 0, 0))}, {0, world_object_}};
  EXPECT_EQ(JudgePick(parts_, scene, Tool(0, 0)).object, "bar");
  EXPECT_FALSE(WouldHold(JudgePick(parts_, rendering::PlannedCapture(), Tool(0, 0))));
}

}  // namespace
}  // namespace graspdb::lab
