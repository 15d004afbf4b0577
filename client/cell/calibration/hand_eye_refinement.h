// Gauss-Newton over the equations of a hand-eye calibration, and how far its result can be trusted.
#pragma once

#include <vector>

#include "client/cell/calibration/hand_eye_equation.h"

namespace graspdb::client {

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
