#include "tests/client/cell/calibration/simulated_cell.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "client/cell/robots/pose_format.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "rendering/camera/scene.h"
#include "rendering/meshes/solid.h"
#include "tests/rendering/small_kinect.h"

namespace graspdb::testing {
namespace {

using client::CameraMount;
using client::FromRotationVector;
using Eigen::Vector3d;
using recognition::Pose;
using rendering::BoxSolid;
using rendering::TriangleMesh;

constexpr double kUnitM = 0.0001;
// Standard deviation of the robot's true pose from its reported one, in all directions together.
constexpr double kShiftNoiseM = 0.0005;
constexpr double kTurnNoiseRad = 0.0035;  // 0.2 degrees
constexpr double kToolLengthM = 0.17;     // from the flange to the fingertips
constexpr double kClearanceM = 0.02;      // of open fingers, see TopGrasp

Pose Make(const Vector3d& at, const Vector3d& turn) {
  Pose out = Pose::Identity();
  out.translation() = at;
  out.linear() = FromRotationVector(turn);
  return out;
}

// Fingers, palm and wrist around an object of that width, in the frame of the flange.
TriangleMesh Gripper(double width_m) {
  const auto half = static_cast<float>(width_m / 2);
  const auto tip = static_cast<float>(kToolLengthM) + 0.012F;
  return rendering::Union({BoxSolid({half, -0.01F, 0.06F}, {half + 0.012F, 0.01F, tip}),
                           BoxSolid({-half - 0.012F, -0.01F, 0.06F}, {-half, 0.01F, tip}),
                           BoxSolid({-half - 0.03F, -0.03F, 0}, {half + 0.03F, 0.03F, 0.06F}),
                           rendering::CylinderSolid({0, 0}, 0.045F, -0.3F, 0)});
}

rendering::DepthCamera CameraOf(const rendering::DepthCameraModel& model) {
  absl::StatusOr<rendering::DepthCamera> camera = rendering::DepthCamera::Create(model);
  if (!camera.ok()) std::abort();
  return *std::move(camera);
}

}  // namespace

SimulatedCell::SimulatedCell(CameraMount mount, const std::string& part,
                             const rendering::DepthCameraModel& camera, std::uint64_t seed)
    : mount_(mount), part_(PartNamed(part)), camera_(CameraOf(camera)), random_(seed) {
  world_base_ = Make({-0.45, 0.12, 0.03}, {0.004, -0.003, 0.4});
  world_camera_ = rendering::LookAt({0.02, 0, 0.3}, 0.75, 40, -85);
  world_camera_.rotate(Eigen::AngleAxisd(0.05, Vector3d::UnitZ()));
  flange_camera_ = Make({0.08, 0.01, 0.04}, {0.06, -0.12, 1.5});
  world_target_ = Make({0.03, -0.02, 0}, {0, 0, std::numbers::pi * Uniform()});
  const v1::Grasp& grasp = part_.grasps.front();
  gripper_ = Gripper(grasp.gripper_opening_m() - kClearanceM);
  // Not quite as taught: a target slips when it is gripped.
  flange_target_ = Make({0, 0, kToolLengthM}, {0, 0, 0}) *
                   files::FromMessage(grasp.tcp_pose()).inverse() *
                   Make({0.001 * Uniform(), 0.001 * Uniform(), 0}, {0.01, -0.02, 0.03});
}

Vector3d SimulatedCell::Normals() {
  std::normal_distribution<double> normal;
  const double x = normal(random_);
  const double y = normal(random_);
  return {x, y, normal(random_)};
}

Pose SimulatedCell::Drive(double tilt_rad, double turn_rad) {
  const double heading = std::numbers::pi * Uniform();
  const Vector3d tilt = tilt_rad * Uniform() * Vector3d(std::cos(heading), std::sin(heading), 0);
  return DriveTo({.world_shown = {0.02, 0, 0.28}, .distance_m = 0.65}, tilt, turn_rad * Uniform());
}

Pose SimulatedCell::DriveProgram(int number, double tilt_rad, double turn_rad) {
  const double heading = number * 150 * std::numbers::pi / 180;
  const Vector3d tilt = tilt_rad * Vector3d(std::cos(heading), std::sin(heading), 0);
  return DriveTo({.world_shown = {0.02, -0.09, 0.36}, .distance_m = 0.6}, tilt,
                 number % 2 == 0 ? turn_rad : -turn_rad);
}

Pose SimulatedCell::DriveTo(const Place& place, const Vector3d& tilt, double turn_rad) {
  const Vector3d turn(0, 0, turn_rad);
  const Vector3d shift(Uniform(), Uniform(), Uniform());
  Pose world_flange = Pose::Identity();
  if (mount_ == CameraMount::kFixed) {
    // The target hangs upright from the tool, but for the tilt.
    const Pose world_target =
        Make(place.world_shown + 0.06 * shift, tilt) * Make(Vector3d::Zero(), turn);
    world_flange = world_target * flange_target_.inverse();
  } else {
    const Pose above =
        rendering::LookAt({0, 0, 0.02}, place.distance_m + 0.06 * shift.z(), 90, -90);
    const Pose around = Make(0.04 * Vector3d(shift.x(), shift.y(), 0), tilt);
    world_flange = around * above * Make(Vector3d::Zero(), turn) * flange_camera_.inverse();
  }
  Pose reported = world_base_.inverse() * world_flange;
  base_flange_ = reported * Make(kShiftNoiseM / std::sqrt(3) * Normals(),
                                 kTurnNoiseRad / std::sqrt(3) * Normals());
  return reported;
}

Pose SimulatedCell::WorldCameraNow() const {
  return mount_ == CameraMount::kFixed ? world_camera_
                                       : world_base_ * base_flange_ * flange_camera_;
}

Pose SimulatedCell::WorldTargetNow() const {
  return mount_ == CameraMount::kFixed ? world_base_ * base_flange_ * flange_target_
                                       : world_target_;
}

Pose SimulatedCell::mount_camera() const {
  return mount_ == CameraMount::kFixed ? world_base_.inverse() * world_camera_ : flange_camera_;
}

Pose SimulatedCell::camera_target() const { return WorldCameraNow().inverse() * WorldTargetNow(); }

absl::StatusOr<client::SensorFrame> SimulatedCell::Next(MonotonicTime /*deadline*/) {
  rendering::Scene scene;
  if (!hidden_) scene.objects.push_back({&part_.mesh, WorldTargetNow()});
  if (mount_ == CameraMount::kFixed) {
    scene.objects.push_back({&gripper_, world_base_ * base_flange_});
  }
  auto frame = camera_.Render(scene, WorldCameraNow(), random_());
  if (!frame.ok()) return frame.status();
  client::SensorFrame out;
  out.scan =
      files::DepthMessage(rendering::ToCounts(*frame, kUnitM), camera_.model().intrinsics, kUnitM);
  out.time = MonotonicTime::Now();
  return out;
}

}  // namespace graspdb::testing
