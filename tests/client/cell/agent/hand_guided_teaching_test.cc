#include "client/cell/agent/jobs/hand_guided_teaching.h"

#include <gmock/gmock.h>

#include "files/messages/pose_message.h"
#include "tests/client/cell/agent/scripted_server.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::HasSubstr;

constexpr double kPi = 3.141592653589793;

Pose At(double x, double y, double z, double turn_about_x = 0) {
  Pose out(Eigen::Translation3d(x, y, z));
  out.rotate(Eigen::AngleAxisd(turn_about_x, Eigen::Vector3d::UnitX()));
  return out;
}

class HandGuidedTeachingTest : public ::testing::Test {
 protected:
  HandGuidedTeachingTest() {
    server_.stable_pose.set_name("objects/mug/stablePoses/upright");
    server_.stable_pose.set_etag("1");
    v1::Grasp* rim = server_.stable_pose.add_grasps();
    rim->set_grasp_id("rim");
    rim->set_priority(9);
    scene_.time = MonotonicTime::Now();
    scene_.frames.world_base = At(0, -1, 0);
    AddObject("mug", world_mug_);
    AddObject("nut", At(0.25, 0, 0));
    job_ = *ParseJob("80 show=top opening=0.05 approach=0.1 retreat=0.2 priority=3");
  }

  void AddObject(const std::string& object, const Pose& world_object) {
    v1::Detection* detection = scene_.answer.add_detections();
    detection->set_status(v1::OK);
    detection->set_object("objects/" + object);
    detection->set_stable_pose("objects/" + object + "/stablePoses/upright");
    *detection->mutable_refined_pose() = files::ToMessage(world_object);
    detection->mutable_centroid()->set_x(world_object.translation().x());
    detection->mutable_centroid()->set_z(0.04);
  }

  // The tool over the mug, pointing down, in the robot's base frame.
  Pose ToolOverMug(double z) const {
    return scene_.frames.world_base.inverse() * At(0.1, 0, z, kPi);
  }

  const Pose world_mug_ = At(0.1, 0, 0) * Pose(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ()));
  ScriptedServer server_;
  Client client_ = server_.Connect();
  SeenScene scene_;
  JobConfig job_;
};

TEST_F(HandGuidedTeachingTest, StoresTheGraspInTheFrameOfTheNearestObject) {
  ASSERT_THAT(StoreShownGrasp(client_, job_, scene_, ToolOverMug(0.09)), IsOk());
  ASSERT_EQ(server_.stable_pose.grasps_size(), 2);
  const v1::Grasp& top = server_.stable_pose.grasps(1);
  EXPECT_EQ(top.grasp_id(), "top");
  EXPECT_EQ(top.gripper_opening_m(), 0.05);
  EXPECT_EQ(top.approach_distance_m(), 0.1);
  EXPECT_EQ(top.retreat_distance_m(), 0.2);
  EXPECT_EQ(top.priority(), 3);
  // Transformed by the mug's pose, it is the tool's pose.
  const Pose world_tcp = world_mug_ * files::FromMessage(top.tcp_pose());
  EXPECT_TRUE(world_tcp.isApprox(At(0.1, 0, 0.09, kPi), 1e-9));
}

TEST_F(HandGuidedTeachingTest, ReplacesAGraspWithTheSameId) {
  job_.shown_grasp.set_grasp_id("rim");
  ASSERT_THAT(StoreShownGrasp(client_, job_, scene_, ToolOverMug(0.09)), IsOk());
  ASSERT_EQ(server_.stable_pose.grasps_size(), 1);
  EXPECT_EQ(server_.stable_pose.grasps(0).priority(), 3);
}

TEST_F(HandGuidedTeachingTest, AToolBelowTheTableIsRejected) {
  EXPECT_THAT(StoreShownGrasp(client_, job_, scene_, ToolOverMug(-0.02)),
              StatusIs(absl::StatusCode::kOutOfRange, HasSubstr("20 mm below the table")));
  // Pointing up, e.g. when the z axis of the tool is inverted.
  const Pose up = scene_.frames.world_base.inverse() * At(0.1, 0, 0.05);
  EXPECT_THAT(StoreShownGrasp(client_, job_, scene_, up),
              StatusIs(absl::StatusCode::kOutOfRange, HasSubstr("50 mm below the table")));
  EXPECT_EQ(server_.stable_pose.grasps_size(), 1);
}

TEST_F(HandGuidedTeachingTest, NoObjectNearTheToolIsAnError) {
  const Pose far = scene_.frames.world_base.inverse() * At(1, 0, 0.1, kPi);
  EXPECT_THAT(StoreShownGrasp(client_, job_, scene_, far), StatusIs(absl::StatusCode::kNotFound));
  job_.object = "objects/plate";
  EXPECT_THAT(StoreShownGrasp(client_, job_, scene_, ToolOverMug(0.09)),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("objects/plate")));
}

TEST_F(HandGuidedTeachingTest, ScenesAreKeptPerRobotForALimitedTime) {
  RobotSession left("left");
  const RobotSession right("right");
  left.SetScene(std::make_shared<SeenScene>(scene_));
  EXPECT_TRUE(RecallScene(left));
  EXPECT_FALSE(RecallScene(right));
  scene_.time = MonotonicTime::Now() - absl::Minutes(11);
  left.SetScene(std::make_shared<SeenScene>(scene_));
  EXPECT_FALSE(RecallScene(left));
}

}  // namespace
}  // namespace graspdb::client
