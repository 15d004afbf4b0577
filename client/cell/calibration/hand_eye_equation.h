// A Y = X B: one pose of the robot and one of the target, and what is unknown.
#pragma once

#include <Eigen/Core>
#include <span>

#include "client/cell/calibration/hand_eye.h"

namespace graspdb::client {

struct HandEyeEquation {
  recognition::Pose a;  // T_base_flange of a fixed camera, T_flange_base of one on the flange
  recognition::Pose b;  // T_camera_target
  CameraMount mount = CameraMount::kFixed;
  Matrix6d covariance = UsualCovariance();  // of b, in the frame of the target
};

struct HandEyeSolution {
  recognition::Pose x = recognition::Pose::Identity();  // HandEye::mount_camera
  recognition::Pose y = recognition::Pose::Identity();  // HandEye::mount_target
};

// The rotation that is nearest to `m`; no mirror image, whatever the sign of its determinant.
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& m);

// Of at least three equations: rotations, then translations, see SolveHandEye.
HandEyeSolution SolveClosedForm(std::span<const HandEyeEquation> equations);

// What is left of A Y = X B: turn and shift in the frame of the target.
Vector6d ErrorOf(const HandEyeEquation& equation, const HandEyeSolution& solution);

// How small turns and shifts in the frame that `pose` is of look in the frame that it is in.
Matrix6d AdjointOf(const recognition::Pose& pose);

// What makes errors of this equation independent of each other and of size one. The detection errs
// in the target's frame, the robot in that of its flange: seen from half a metre away, a turn of it
// is a shift.
Matrix6d WhiteningOf(const HandEyeEquation& equation, const HandEyeSolution& solution);

// Of an error, in units of what is to be expected.
double SizeOf(const HandEyeEquation& equation, const HandEyeSolution& solution);

}  // namespace graspdb::client
