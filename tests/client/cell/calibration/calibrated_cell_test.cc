#include "client/cell/calibration/calibrated_cell.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <numbers>

#include "client/cell/agent/jobs/cell_frames.h"
#include "files/messages/pose_message.h"
#include "tests/client/cell/calibration/calibration_server.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using graspdb::testing::CalibrationServer;
using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kCell[] = "cells/press-1";

Pose Make(const Vector3d& at, double angle, const Vector3d& axis) {
  Pose out = Pose::Identity();
  out.translation() = at;
  out.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return out;
}

const Pose sensor_in_world = Make({0.1, -0.4, 0.8}, 2.6, {1, 0.1, 0});
const Pose camera_on_mount = Make({0.06, -0.02, 0.05}, 0.2, {1, 0.5, 0.3});
const Pose base_in_world = Make({-0.4, 0.1, 0.02}, 0.3, {0, 0, 1});

HandEye Found(const Pose& mount_camera, const Pose& mount_target = Pose::Identity()) {
  return {.mount_camera = mount_camera, .mount_target = mount_target, .residuals = {}};
}

v1::Cell CellWith(const Pose* world_sensor, const Pose* flange_sensor, const Pose* world_base) {
  v1::Cell cell;
  cell.set_name(kCell);
  cell.set_etag("7");
  if (world_sensor != nullptr) *cell.mutable_sensor_pose() = files::ToMessage(*world_sensor);
  if (flange_sensor != nullptr)
    *cell.mutable_flange_sensor_pose() = files::ToMessage(*flange_sensor);
  if (world_base != nullptr) *cell.mutable_robot_base_pose() = files::ToMessage(*world_base);
  return cell;
}

// The cell on a server after calibrating `cell`.
absl::StatusOr<v1::Cell> Saved(const v1::Cell& cell, const HandEye& hand_eye, CameraMount mount) {
  CalibrationServer server;
  v1::CreateCellRequest create;
  create.set_cell_id("press-1");
  *create.mutable_cell() = cell;
  const auto made = server.client().CreateCell(create);
  if (!made.ok()) return made.status();
  const auto update = CalibratedCell(*made, hand_eye, mount);
  if (!update.ok()) return update.status();
  return server.client().UpdateCell(*update);
}

TEST(CalibratedCell, AFixedCameraClearsTheFlangeCamera) {
  const auto saved = Saved(CellWith(&sensor_in_world, &camera_on_mount, nullptr),
                           Found(Make({0.5, 0, 1}, 3, {1, 0, 0})), CameraMount::kFixed);
  ASSERT_THAT(saved, IsOk());
  EXPECT_EQ(MountOf(*saved), CameraMount::kFixed);
  const auto frames = FramesOf(*saved);
  ASSERT_THAT(frames, IsOk());
  const auto camera = WorldSensor(*frames, Pose::Identity(), std::nullopt);
  ASSERT_THAT(camera, IsOk());
  EXPECT_TRUE(camera->isApprox(sensor_in_world, 1e-9));
  const auto found = MountCameraOf(*saved);
  ASSERT_THAT(found, IsOk());
  EXPECT_TRUE(found->isApprox(Make({0.5, 0, 1}, 3, {1, 0, 0}), 1e-9));
}

TEST(CalibratedCell, AFlangeCameraClearsTheFixedCamera) {
  const auto saved = Saved(CellWith(&sensor_in_world, nullptr, &base_in_world),
                           Found(camera_on_mount), CameraMount::kOnFlange);
  ASSERT_THAT(saved, IsOk());
  EXPECT_EQ(MountOf(*saved), CameraMount::kOnFlange);
  EXPECT_FALSE(saved->has_sensor_pose()) << "scans without a pose would be put there";
  EXPECT_TRUE(files::FromMessage(saved->flange_sensor_pose()).isApprox(camera_on_mount, 1e-9));
}

TEST(CalibratedCell, AFlangeCameraKeepsAKnownRobotBase) {
  const auto update = CalibratedCell(CellWith(nullptr, nullptr, &base_in_world),
                                     Found(camera_on_mount), CameraMount::kOnFlange);
  ASSERT_THAT(update, IsOk());
  EXPECT_THAT(update->update_mask().paths(), ElementsAre("flange_sensor_pose", "sensor_pose"));
  EXPECT_EQ(update->cell().etag(), "7") << "a cell that was changed meanwhile must stay";
}

TEST(CalibratedCell, WithoutARobotBaseTheOriginIsUnderTheRobot) {
  // The target is on a table 0.1 m below the robot's origin, turned about the vertical.
  const auto update = CalibratedCell(CellWith(nullptr, nullptr, nullptr),
                                     Found(camera_on_mount, Make({0.5, 0.2, -0.1}, 0.7, {0, 0, 1})),
                                     CameraMount::kOnFlange);
  ASSERT_THAT(update, IsOk());
  const Pose world_base = files::FromMessage(update->cell().robot_base_pose());
  EXPECT_TRUE(world_base.isApprox(Make({0, 0, 0.1}, 0, {0, 0, 1}), 1e-9));
}

TEST(CalibratedCell, AnUndeterminedWorldFrameIsRejected) {
  EXPECT_THAT(CalibratedCell(CellWith(nullptr, nullptr, &base_in_world), {}, CameraMount::kFixed),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("cells level")));
  const HandEye lying = Found(camera_on_mount, Make({0.5, 0, 0}, std::numbers::pi / 2, {0, 1, 0}));
  EXPECT_THAT(CalibratedCell(CellWith(nullptr, nullptr, nullptr), lying, CameraMount::kOnFlange),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("cells set")));
}

TEST(MountCameraOf, AnUncalibratedCellIsRejected) {
  EXPECT_THAT(MountCameraOf(CellWith(&sensor_in_world, nullptr, nullptr)),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("not calibrated")));
}

TEST(MeanTarget, IsTheMeanAndNoReflection) {
  const Vector3d at(0.1, 0.2, 0.3);
  std::vector<HandEyeSample> samples;
  const auto add = [&](int count, double angle, const Vector3d& axis) {
    for (int i = 0; i < count; ++i) samples.push_back({.camera_target = Make(at, angle, axis)});
  };
  // Their sum is diag(-1, 3, 3), whose determinant is negative.
  add(3, 0, Vector3d::UnitX());
  add(2, std::numbers::pi, Vector3d::UnitY());
  add(2, std::numbers::pi, Vector3d::UnitZ());
  const Pose mean = MeanTarget(samples, CameraMount::kOnFlange, Pose::Identity());
  EXPECT_TRUE(mean.linear().isApprox(Eigen::Matrix3d::Identity(), 1e-9)) << mean.linear();
  EXPECT_TRUE(mean.translation().isApprox(at, 1e-9));
}

}  // namespace
}  // namespace graspdb::client
