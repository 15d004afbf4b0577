// Conversion of vectors, poses and boxes from and to messages of the contract.
#pragma once

#include <string_view>

#include "absl/status/status.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"

namespace graspdb::files {

v1::Vector3 ToMessage(const Eigen::Vector3d& vector);
v1::Quaternion ToMessage(const Eigen::Quaterniond& rotation);
Eigen::Vector3d FromMessage(const v1::Vector3& message);

// T_a_b, metres; the quaternion is normalised and has w >= 0.
v1::Pose ToMessage(const recognition::Pose& pose);

// The pose of a message that CheckPose accepts; the quaternion is normalised.
recognition::Pose FromMessage(const v1::Pose& message);

recognition::Box FromMessage(const v1::AxisAlignedBox& message);

// INVALID_ARGUMENT, beginning with `field`, when a number is not finite or the
// norm of the quaternion is off one by more than 1e-3.
absl::Status CheckPose(const v1::Pose& message, std::string_view field);

}  // namespace graspdb::files
