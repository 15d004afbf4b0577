#include "client/cell/calibration/hand_eye_equation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "client/cell/robots/pose_format.h"

namespace graspdb::client {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using recognition::Pose;
using Vector12d = Eigen::Matrix<double, 12, 1>;

// Of any size: one type to compile for 3 x 3 and 9 x 9.
using Svd = Eigen::JacobiSVD<Eigen::MatrixXd>;

// The rotation in a singular vector, whose sign is arbitrary.
Matrix3d RotationIn(const Eigen::Matrix<double, 9, 1>& vector) {
  const Matrix3d m = Eigen::Map<const Matrix3d>(vector.data());  // column by column
  return NearestRotation(m.determinant() < 0 ? Matrix3d(-m) : m);
}

Matrix3d CrossMatrix(const Vector3d& v) {
  Matrix3d out;
  out << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return out;
}

constexpr int kRefinementSteps = 20;

Pose Moved(const Pose& pose, const Vector6d& step) {
  Pose by = Pose::Identity();
  by.linear() = FromRotationVector(step.head<3>());
  by.translation() = step.tail<3>();
  return pose * by;
}

// The adjoint of `pose`: maps small turns and shifts from its child frame to its parent frame.
Matrix6d AdjointOf(const Pose& pose) {
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = pose.linear();
  out.bottomLeftCorner<3, 3>() = CrossMatrix(pose.translation()) * pose.linear();
  return out;
}

// Whitens the errors of this equation: independent, with unit variance. Detection errors are given
// in the target's frame, robot errors in the flange's: half a metre away, a turn of the flange is a
// shift.
Matrix6d WhiteningOf(const HandEyeEquation& equation, const HandEyeSolution& solution) {
  const Pose target_flange = equation.mount == CameraMount::kFixed
                                 ? solution.y.inverse()
                                 : (solution.x * equation.b).inverse();
  const Matrix6d adjoint = AdjointOf(target_flange);
  const Matrix6d covariance =
      adjoint * UsualCovariance() * adjoint.transpose() + equation.covariance;
  const Eigen::LLT<Matrix6d> factor(covariance);
  return factor.matrixL().solve(Matrix6d::Identity());
}

}  // namespace

Matrix3d NearestRotation(const Matrix3d& m) {
  const Svd svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d u = svd.matrixU();
  const Matrix3d v = svd.matrixV();
  if ((u * v.transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * v.transpose();
}

HandEyeSolution SolveClosedForm(std::span<const HandEyeEquation> equations) {
  Eigen::Matrix<double, 9, 9> sum = Eigen::Matrix<double, 9, 9>::Zero();
  for (const auto& [a, b, mount, covariance] : equations) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j < 3; ++j) {
        sum.block<3, 3>(3 * i, 3 * j) += b.linear()(i, j) * a.linear();
      }
    }
  }
  const Svd svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  HandEyeSolution out;
  out.x.linear() = RotationIn(svd.matrixU().col(0));
  out.y.linear() = RotationIn(svd.matrixV().col(0));

  const auto rows = static_cast<Eigen::Index>(3 * equations.size());
  Eigen::MatrixXd left(rows, 6);
  Eigen::VectorXd right(rows);
  for (std::size_t i = 0; i < equations.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    const auto& [a, b, mount, covariance] = equations[i];
    left.block<3, 3>(row, 0) = a.linear();
    left.block<3, 3>(row, 3) = -Matrix3d::Identity();
    right.segment<3>(row) = out.x.linear() * b.translation() - a.translation();
  }
  const Vector6d found = left.colPivHouseholderQr().solve(right);
  out.y.translation() = found.head<3>();
  out.x.translation() = found.tail<3>();
  return out;
}

Vector6d ErrorOf(const HandEyeEquation& equation, const HandEyeSolution& solution) {
  const Pose error = (solution.x * equation.b).inverse() * equation.a * solution.y;
  Vector6d out;
  out << RotationVector(error.linear()), error.translation();
  return out;
}

double SizeOf(const HandEyeEquation& equation, const HandEyeSolution& solution) {
  return (WhiteningOf(equation, solution) * ErrorOf(equation, solution)).norm();
}

// The Jacobian of the error is the identity for Y, and minus the adjoint of B^-1 for X.
RefinedHandEye Refine(const std::vector<HandEyeEquation>& equations, HandEyeSolution solution) {
  RefinedHandEye out{.solution = std::move(solution)};
  for (int step = 0; step < kRefinementSteps; ++step) {
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
