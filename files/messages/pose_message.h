// Conversion of poses and boxes between protobuf messages and the algorithms.
#pragma once

#include <string_view>

#include "absl/status/status.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"

namespace graspdb::files {

// T_a_b, metres; the quaternion is normalised and has w >= 0.
v1::Pose ToMessage(const recognition::Pose& pose);

// The pose of a message that CheckPose accepts; the quaternion is normalised.
recognition::Pose FromMessage(const v1::Pose& message);

recognition::Box FromMessage(const v1::AxisAlignedBox& message);

// INVALID_ARGUMENT, beginning with `field`, when a number is not finite or the
// norm of the quaternion is off one by more than 1e-3.
absl::Status CheckPose(const v1::Pose& message, std::string_view field);

}  // namespace graspdb::files
