#include "files/messages/pose_message.h"

#include <cmath>

#include "absl/strings/str_cat.h"

namespace graspdb::files {
namespace {

constexpr double kQuaternionTolerance = 1e-3;

Eigen::Quaterniond Rotation(const v1::Pose& message) {
  const v1::Quaternion& q = message.orientation();
  return {q.w(), q.x(), q.y(), q.z()};
}

Eigen::Vector3d VectorOf(const v1::Vector3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

v1::Pose ToMessage(const recognition::Pose& pose) {
  Eigen::Quaterniond q(pose.linear());
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  v1::Pose message;
  message.mutable_position()->set_x(pose.translation().x());
  message.mutable_position()->set_y(pose.translation().y());
  message.mutable_position()->set_z(pose.translation().z());
  message.mutable_orientation()->set_x(q.x());
  message.mutable_orientation()->set_y(q.y());
  message.mutable_orientation()->set_z(q.z());
  message.mutable_orientation()->set_w(q.w());
  return message;
}

recognition::Pose FromMessage(const v1::Pose& message) {
  recognition::Pose pose = recognition::Pose::Identity();
  pose.linear() = Rotation(message).normalized().toRotationMatrix();
  pose.translation() = VectorOf(message.position());
  return pose;
}

recognition::Box FromMessage(const v1::AxisAlignedBox& message) {
  return {VectorOf(message.min()), VectorOf(message.max())};
}

absl::Status CheckPose(const v1::Pose& message, std::string_view field) {
  const absl::string_view name(field.data(), field.size());
  if (!VectorOf(message.position()).allFinite() || !Rotation(message).coeffs().allFinite()) {
    return absl::InvalidArgumentError(absl::StrCat(
        name, " has a number that is not finite; leave the pose out if it is unknown"));
  }
  const double norm = Rotation(message).norm();
  if (std::abs(norm - 1) > kQuaternionTolerance) {
    return absl::InvalidArgumentError(
        absl::StrCat(name, ".orientation has the norm ", norm,
                     "; give a unit quaternion, for no rotation {\"w\": 1}"));
  }
  return absl::OkStatus();
}

}  // namespace graspdb::files
