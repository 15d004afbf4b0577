// A Y = X B: a pose of the robot A, a pose of the target B, and the unknowns X and Y; solved in
// closed form, then by Gauss-Newton.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

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

// The rotation nearest to `m`; never a reflection, whatever the sign of the determinant.
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& m);

// Closed-form solution of at least three equations: rotations, then translations, see SolveHandEye.
HandEyeSolution SolveClosedForm(std::span<const HandEyeEquation> equations);

// Residual of A Y = X B: turn and shift in the frame of the target.
Vector6d ErrorOf(const HandEyeEquation& equation, const HandEyeSolution& solution);

// Norm of the whitened error.
double SizeOf(const HandEyeEquation& equation, const HandEyeSolution& solution);

// Whitened error above which a sample is an outlier: a false detection, or the target slipped.
inline constexpr double kMaxInlierSize = 10;

using Matrix12d = Eigen::Matrix<double, 12, 12>;

struct RefinedHandEye {
  HandEyeSolution solution;
  Matrix12d information = Matrix12d::Zero();  // of small moves of x, then of y, in their frames
};

// Tukey's weights make outliers count less, from kMaxInlierSize on nothing.
RefinedHandEye Refine(const std::vector<HandEyeEquation>& equations, HandEyeSolution solution);

// Of a refined solution of inliers.
HandEyeCertainty CertaintyOf(const std::vector<HandEyeEquation>& inliers,
                             const HandEyeSolution& solution);

}  // namespace graspdb::client
