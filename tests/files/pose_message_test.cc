#include "files/messages/pose_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace graspdb::files {
namespace {

TEST(PoseMessage, RoundTripKeepsThePose) {
  recognition::Pose pose = recognition::Pose::Identity();
  pose.linear() =
      Eigen::AngleAxisd(3.0, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.1, -0.2, 0.3);
  EXPECT_TRUE(FromMessage(ToMessage(pose)).isApprox(pose, 1e-12));
  EXPECT_TRUE(CheckPose(ToMessage(pose), "p").ok());
  EXPECT_GE(ToMessage(pose).orientation().w(), 0);
}

TEST(PoseMessage, AlmostUnitQuaternionIsNormalised) {
  v1::Pose message;
  message.mutable_orientation()->set_w(1.0009);
  EXPECT_TRUE(CheckPose(message, "p").ok());
  EXPECT_TRUE(FromMessage(message).linear().isIdentity(1e-12));
}

TEST(PoseMessage, InvalidPosesAreRejectedWithTheField) {
  v1::Pose message;
  EXPECT_THAT(std::string(CheckPose(message, "here").message()),
              ::testing::StartsWith("here.orientation has the norm 0"));
  message.mutable_orientation()->set_w(1.002);
  EXPECT_FALSE(CheckPose(message, "here").ok());
  message.mutable_orientation()->set_w(1);
  message.mutable_position()->set_y(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(std::string(CheckPose(message, "here").message()),
              ::testing::HasSubstr("not finite"));
}

}  // namespace
}  // namespace graspdb::files
