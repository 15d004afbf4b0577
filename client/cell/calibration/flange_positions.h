// Whether the positions that a robot sends can be those of its flange in metres.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "client/cell/calibration/hand_eye.h"
#include "client/cell/calibration/hand_eye_equation.h"

namespace graspdb::client {

// FAILED_PRECONDITION when the flange hardly moves, is always within the robot's base, or is
// farther away than any robot reaches. With poses on a sphere around the target nothing else shows
// that positions are a thousand times too small: the camera turns about the target, and the
// calibration would put the flange there.
absl::Status CheckFlangePositions(std::span<const HandEyeSample> samples);

// The factor by which the flange's positions are to be multiplied so that they fit the poses of the
// target: 1000 where metres were sent in place of millimetres. nullopt where the poses do not show
// it, or where it is about 1. `x_rotation`: of the camera, HandEyeSolution::x.
std::optional<double> WrongScaleOf(const std::vector<HandEyeEquation>& equations,
                                   const Eigen::Matrix3d& x_rotation);

}  // namespace graspdb::client
