#include "client/cell/calibration/hand_eye_equation.h"

#include <Eigen/Dense>

#include "client/cell/robots/rotation_vector.h"

namespace graspdb::client {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using recognition::Pose;

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

Matrix6d AdjointOf(const Pose& pose) {
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = pose.linear();
  out.bottomLeftCorner<3, 3>() = CrossMatrix(pose.translation()) * pose.linear();
  return out;
}

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

double SizeOf(const HandEyeEquation& equation, const HandEyeSolution& solution) {
  return (WhiteningOf(equation, solution) * ErrorOf(equation, solution)).norm();
}

}  // namespace graspdb::client
