// The world frame that a table plane makes.
#include <gtest/gtest.h>

#include "recognition/points/plane.h"
#include "tests/recognition/scenes/table_scene.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::LookAt;

// The world's table as a sensor at `world_sensor` sees it.
Plane TableSeenFrom(const Pose& world_sensor) {
  const Vector3d normal = world_sensor.linear().transpose() * Vector3d::UnitZ();
  return {normal, -world_sensor.translation().z()};
}

std::optional<Pose> WorldOf(const Plane& table) {
  return WorldFromPlane(table, Vector3d::Zero(), Vector3d::UnitZ(), Vector3d::UnitX());
}

TEST(WorldFromPlaneTest, PlaneIsTheTableAtZeroWithZUp) {
  const Plane table = TableSeenFrom(LookAt({0.3, -0.5, 0.6}, {0.1, 0.05, 0}));
  const auto world_sensor = WorldOf(table);
  ASSERT_TRUE(world_sensor);
  EXPECT_TRUE((world_sensor->linear() * table.normal).isApprox(Vector3d::UnitZ(), 1e-12));
  EXPECT_NEAR(world_sensor->translation().z(), 0.6, 1e-12);
  EXPECT_NEAR((*world_sensor * Vector3d(table.offset * table.normal)).z(), 0, 1e-12);
  EXPECT_NEAR(world_sensor->linear().determinant(), 1, 1e-12);
}

TEST(WorldFromPlaneTest, OriginLiesWhereTheOpticalAxisMeetsTheTable) {
  const Vector3d eye(0.3, -0.5, 0.6);
  const Vector3d target(0.1, 0.05, 0);
  const auto world_sensor = WorldOf(TableSeenFrom(LookAt(eye, target)));
  ASSERT_TRUE(world_sensor);
  const Vector3d hit = *world_sensor * Vector3d(0, 0, (target - eye).norm());
  EXPECT_NEAR(hit.norm(), 0, 1e-12);
}

TEST(WorldFromPlaneTest, XPointsToTheRightOfTheImageAndYAwayFromTheSensor) {
  const auto world_sensor = WorldOf(TableSeenFrom(LookAt({0, -0.5, 0.6}, {0, 0, 0})));
  ASSERT_TRUE(world_sensor);
  EXPECT_TRUE((world_sensor->linear() * Vector3d::UnitX()).isApprox(Vector3d::UnitX(), 1e-12));
  EXPECT_LT(world_sensor->translation().y(), -0.4);
}

TEST(WorldFromPlaneTest, RolledSensorStillHasXInTheTable) {
  Pose rolled = LookAt({0, -0.5, 0.6}, {0, 0, 0});
  rolled.linear() *= Eigen::AngleAxisd(0.4, Vector3d::UnitZ()).toRotationMatrix();
  const auto world_sensor = WorldOf(TableSeenFrom(rolled));
  ASSERT_TRUE(world_sensor);
  const Vector3d right = world_sensor->linear() * Vector3d::UnitX();
  EXPECT_NEAR(right.y(), 0, 1e-12);
  EXPECT_GT(right.x(), 0);
}

TEST(WorldFromPlaneTest, LookingStraightDownIsNoSpecialCase) {
  const auto world_sensor = WorldOf({-Vector3d::UnitZ(), -0.7});
  ASSERT_TRUE(world_sensor);
  Pose truth = Pose::Identity();
  truth.linear() = Vector3d(1, -1, -1).asDiagonal();
  truth.translation() = Vector3d(0, 0, 0.7);
  EXPECT_TRUE(world_sensor->isApprox(truth, 1e-12));
}

TEST(WorldFromPlaneTest, RayAlongThePlaneGivesNoFrame) {
  EXPECT_FALSE(WorldOf({-Vector3d::UnitY(), -0.3}));
}

TEST(WorldFromPlaneTest, PlaneBehindTheSensorGivesNoFrame) {
  EXPECT_FALSE(WorldOf({Vector3d::UnitZ(), -0.5}));
}

TEST(WorldFromPlaneTest, RightPerpendicularToThePlaneGivesNoFrame) {
  EXPECT_FALSE(WorldFromPlane({-Vector3d::UnitZ(), -0.7}, Vector3d::Zero(), Vector3d::UnitZ(),
                              Vector3d::UnitZ()));
}

}  // namespace
}  // namespace graspdb::recognition
