// Rotations as axis times angle.
#pragma once

#include <Eigen/Geometry>

namespace graspdb::client {

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
