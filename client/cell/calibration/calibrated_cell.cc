#include "client/cell/calibration/calibrated_cell.h"

#include <Eigen/Geometry>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/calibration/hand_eye_equation.h"
#include "files/messages/pose_message.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::Pose;

// Minimum sine of the angle between the base's x axis and the vertical for x to be a heading.
constexpr double kMinLevel = 0.1;

// T_base_world from a target that stands on the table.
absl::StatusOr<Pose> WorldUnder(const Pose& base_target) {
  const Vector3d up = base_target.linear().col(2);
  const Vector3d ahead = Vector3d::UnitX() - up * up.x();
  if (ahead.norm() < kMinLevel) {
    return absl::FailedPreconditionError(
        "the robot's x axis points along the vertical of the table: give the cell its robot base "
        "pose with `graspdb cells set`");
  }
  Pose base_world = Pose::Identity();
  base_world.linear() << ahead.normalized(), up.cross(ahead.normalized()), up;
  base_world.translation() = up * up.dot(base_target.translation());
  return base_world;
}

}  // namespace

absl::StatusOr<v1::UpdateCellRequest> CalibratedCell(const v1::Cell& cell, const HandEye& hand_eye,
                                                     CameraMount mount) {
  v1::UpdateCellRequest out;
  out.mutable_cell()->set_name(cell.name());
  out.mutable_cell()->set_etag(cell.etag());
  if (mount == CameraMount::kFixed) {
    if (!cell.has_sensor_pose()) {
      return absl::FailedPreconditionError(absl::StrCat(
          cell.name(),
          " has no sensor pose relative to the table; run `graspdb cells level` with a "
          "frame of the empty table first"));
    }
    *out.mutable_cell()->mutable_robot_base_pose() =
        files::ToMessage(files::FromMessage(cell.sensor_pose()) * hand_eye.mount_camera.inverse());
    out.mutable_update_mask()->add_paths("robot_base_pose");
    // In the mask but not set, so cleared: a flange_sensor_pose would take precedence.
    out.mutable_update_mask()->add_paths("flange_sensor_pose");
    return out;
  }
  *out.mutable_cell()->mutable_flange_sensor_pose() = files::ToMessage(hand_eye.mount_camera);
  out.mutable_update_mask()->add_paths("flange_sensor_pose");
  out.mutable_update_mask()->add_paths("sensor_pose");  // cleared: the camera is no longer fixed
  if (cell.has_robot_base_pose()) return out;
  ASSIGN_OR_RETURN(const Pose base_world, WorldUnder(hand_eye.mount_target));
  *out.mutable_cell()->mutable_robot_base_pose() = files::ToMessage(base_world.inverse());
  out.mutable_update_mask()->add_paths("robot_base_pose");
  return out;
}

CameraMount MountOf(const v1::Cell& cell) {
  return cell.has_flange_sensor_pose() ? CameraMount::kOnFlange : CameraMount::kFixed;
}

absl::StatusOr<Pose> MountCameraOf(const v1::Cell& cell) {
  if (MountOf(cell) == CameraMount::kOnFlange) return files::FromMessage(cell.flange_sensor_pose());
  if (!cell.has_sensor_pose() || !cell.has_robot_base_pose()) {
    return absl::FailedPreconditionError(
        absl::StrCat(cell.name(),
                     " is not calibrated; run `graspdb cells level` and then the hand-eye "
                     "calibration through the robot"));
  }
  return files::FromMessage(cell.robot_base_pose()).inverse() *
         files::FromMessage(cell.sensor_pose());
}

Pose MeanTarget(const std::vector<HandEyeSample>& samples, CameraMount mount,
                const Pose& mount_camera) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
  Vector3d position = Vector3d::Zero();
  for (const HandEyeSample& sample : samples) {
    const Pose target =
        (mount == CameraMount::kFixed ? sample.base_flange.inverse() : sample.base_flange) *
        mount_camera * sample.camera_target;
    rotation += target.linear();
    position += target.translation();
  }
  Pose out = Pose::Identity();
  out.linear() = NearestRotation(rotation);
  out.translation() = position / static_cast<double>(samples.size());
  return out;
}

}  // namespace graspdb::client
