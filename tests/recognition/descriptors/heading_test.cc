#include "recognition/descriptors/heading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;

// At `eye`, looking at the origin, the image's lower side towards `down` as far as that goes.
Pose LookingFrom(const Vector3d& eye, const Vector3d& down) {
  const Vector3d z = -eye.normalized();
  const Vector3d x = down.cross(z).normalized();
  Pose pose = Pose::Identity();
  pose.linear() << x, z.cross(x), z;
  pose.translation() = eye;
  return pose;
}

TEST(SideSeen, IsTheCamerasSideForAnObliqueView) {
  const Pose sensor = LookingFrom({0.6, 0, 0.5}, -Vector3d::UnitZ());
  EXPECT_TRUE(SideSeen(sensor, Vector3d::Zero()).isApprox(Vector3d::UnitX(), 1e-9));
  const Vector3d off = SideSeen(sensor, {0, 0.2, 0});
  EXPECT_NEAR(std::atan2(off.y(), off.x()), std::atan2(-0.2, 0.6), 1e-9);
}

TEST(SideSeen, IsTheLowerSideOfTheImageForAViewFromAbove) {
  const Pose sensor = LookingFrom({0, 0, 0.8}, -Vector3d::UnitY());
  for (const Vector3d& point : {Vector3d(0.1, 0, 0), Vector3d(-0.1, 0.05, 0), Vector3d(0, 0, 0)}) {
    EXPECT_TRUE(SideSeen(sensor, point).isApprox(-Vector3d::UnitY(), 1e-9));
  }
}

TEST(SideSeen, IsConstantInTheMiddleOfTheImageInTheSensorFrame) {
  for (const Vector3d& point : {Vector3d(0.02, 0.01, 0.8), Vector3d(-0.02, -0.01, 0.8)}) {
    EXPECT_TRUE(SideSeen(Pose::Identity(), point).isApprox(Vector3d::UnitY(), 1e-9));
  }
}

TEST(SideSeen, IsContinuousBetweenObliqueAndSteep) {
  Vector3d before = SideSeen(LookingFrom({0.01, 0, 1}, -Vector3d::UnitY()), Vector3d::Zero());
  for (double off = 0.02; off < 0.6; off += 0.01) {
    // The image's lower side stays at -y, the camera moves to +x.
    Pose sensor(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()));
    sensor.translation() = Vector3d(off, 0, 1);
    const Vector3d side = SideSeen(sensor, Vector3d::Zero());
    EXPECT_NEAR(side.norm(), 1, 1e-9);
    EXPECT_LT((side - before).norm(), 0.2) << off;
    before = side;
  }
  EXPECT_TRUE(before.isApprox(Vector3d::UnitX(), 1e-6));
}

}  // namespace
}  // namespace graspdb::recognition
