// Pose formats of robots: the 51 of the Generic Robot Interface.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// Codes of the formats without Euler angles; the others are Euler angles, 4 + 4 sequence +
// 2 backward + radians.
inline constexpr int kQuaternionWxyz = 1;  // ABB
inline constexpr int kQuaternionXyzw = 2;
inline constexpr int kRotationVector = 3;  // axis times angle, radians; Universal Robots
inline constexpr int kLastPoseFormat = 51;

// The unit of a rotation's numbers.
enum class RotationUnit {
  kQuaternion,  // four, without a unit
  kRadians,     // three
  kDegrees,     // three
};
RotationUnit RotationUnitOf(int code);

// A pose as numbers: millimetres, and up to four numbers of the format's unit, 0 where unused.
struct RobotPose {
  std::array<double, 3> position_mm = {};
  std::array<double, 4> rotation = {};
};

// `pose` in the format `code`. Of equivalent Euler angles, those whose middle angle is within
// +-90 degrees (sequences of three axes) or not negative (of two), and the others within +-180;
// where only the sum of first and last is determined, the last is 0. A rotation vector is not
// longer than pi, a quaternion's w not negative. INVALID_ARGUMENT when there is no such format.
absl::StatusOr<RobotPose> ToRobotPose(const recognition::Pose& pose, int code);

// The inverse. INVALID_ARGUMENT when there is no such format, when a number is not finite, or when
// the length of a quaternion is not one, within a hundredth.
absl::StatusOr<recognition::Pose> FromRobotPose(const RobotPose& numbers, int code);

// Axis times angle of a rotation matrix, radians; not longer than pi.
inline Eigen::Vector3d RotationVector(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

// The inverse; the identity for zero.
inline Eigen::Matrix3d FromRotationVector(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (!(angle > 0)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

}  // namespace graspdb::client
