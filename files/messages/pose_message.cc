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

}  // namespace

v1::Vector3 ToMessage(const Eigen::Vector3d& vector) {
  v1::Vector3 message;
  message.set_x(vector.x());
  message.set_y(vector.y());
  message.set_z(vector.z());
  return message;
}

Eigen::Vector3d FromMessage(const v1::Vector3& message) {
  return {message.x(), message.y(), message.z()};
}

v1::Quaternion ToMessage(const Eigen::Quaterniond& rotation) {
  v1::Quaternion message;
  message.set_x(rotation.x());
  message.set_y(rotation.y());
  message.set_z(rotation.z());
  message.set_w(rotation.w());
  return message;
}

v1::Pose ToMessage(const recognition::Pose& pose) {
  Eigen::Quaterniond q(pose.linear());
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  v1::Pose message;
  *message.mutable_position() = ToMessage(pose.translation());
  *message.mutable_orientation() = ToMessage(q);
  return message;
}

recognition::Pose FromMessage(const v1::Pose& message) {
  recognition::Pose pose = recognition::Pose::Identity();
  pose.linear() = Rotation(message).normalized().toRotationMatrix();
  pose.translation() = FromMessage(message.position());
  return pose;
}

recognition::Box FromMessage(const v1::AxisAlignedBox& message) {
  return {FromMessage(message.min()), FromMessage(message.max())};
}

absl::Status CheckPose(const v1::Pose& message, std::string_view field) {
  const absl::string_view name(field.data(), field.size());
  if (!FromMessage(message.position()).allFinite() || !Rotation(message).coeffs().allFinite()) {
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
