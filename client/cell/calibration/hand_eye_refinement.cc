#include "client/cell/calibration/hand_eye_refinement.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "client/cell/robots/rotation_vector.h"

namespace graspdb::client {
namespace {

using recognition::Pose;
using Vector12d = Eigen::Matrix<double, 12, 1>;

constexpr int kSteps = 20;

Pose Moved(const Pose& pose, const Vector6d& step) {
  Pose by = Pose::Identity();
  by.linear() = FromRotationVector(step.head<3>());
  by.translation() = step.tail<3>();
  return pose * by;
}

}  // namespace

// The Jacobian of the error is the identity for Y, and minus the adjoint of B^-1 for X.
RefinedHandEye Refine(const std::vector<HandEyeEquation>& equations, HandEyeSolution solution) {
  RefinedHandEye out{.solution = std::move(solution)};
  for (int step = 0; step < kSteps; ++step) {
    Matrix12d hessian = Matrix12d::Zero();
    Vector12d gradient = Vector12d::Zero();
    for (const HandEyeEquation& equation : equations) {
      const Matrix6d whiten = WhiteningOf(equation, out.solution);
      const Vector6d error = whiten * ErrorOf(equation, out.solution);
      const double share = error.norm() / kMaxInlierSize;
      if (share >= 1) continue;
      Eigen::Matrix<double, 6, 12> rows;
      rows << -AdjointOf(equation.b.inverse()), Matrix6d::Identity();
      rows = (whiten * rows).eval();
      const double weight = (1 - share * share) * (1 - share * share);  // Tukey's
      hessian += weight * rows.transpose() * rows;
      gradient += weight * rows.transpose() * error;
    }
    hessian.diagonal().array() += 1e-9;
    out.information = hessian;
    const Vector12d move = -hessian.ldlt().solve(gradient);
    out.solution.x = Moved(out.solution.x, move.head<6>());
    out.solution.y = Moved(out.solution.y, move.tail<6>());
    if (move.norm() < 1e-12) break;
  }
  return out;
}

HandEyeCertainty CertaintyOf(const std::vector<HandEyeEquation>& inliers,
                             const HandEyeSolution& solution) {
  HandEyeCertainty out;
  const RefinedHandEye all = Refine(inliers, solution);
  double squares = 0;  // whitened: one for each number, if the noise is the usual one
  for (std::size_t i = 0; i < inliers.size(); ++i) {
    const double size = SizeOf(inliers[i], all.solution);
    squares += size * size;
    std::vector<HandEyeEquation> others = inliers;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Vector6d error = ErrorOf(inliers[i], Refine(others, all.solution).solution);
    out.left_out_turn_rad += error.head<3>().squaredNorm();
    out.left_out_shift_m += error.tail<3>().squaredNorm();
  }
  const auto count = static_cast<double>(inliers.size());
  out.left_out_turn_rad = std::sqrt(out.left_out_turn_rad / count);
  out.left_out_shift_m = std::sqrt(out.left_out_shift_m / count);
  const Matrix12d covariance = all.information.ldlt().solve(Matrix12d::Identity());
  const Eigen::Matrix3d of_position = covariance.block<3, 3>(3, 3);
  const double variance =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(of_position).eigenvalues()[2];
  out.weakest_m = std::sqrt(variance * std::max(1.0, squares / std::max(1.0, 6 * count - 12)));
  return out;
}

}  // namespace graspdb::client
