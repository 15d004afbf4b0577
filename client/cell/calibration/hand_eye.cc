#include "client/cell/calibration/hand_eye.h"

#include <Eigen/Core>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cell/calibration/hand_eye_equation.h"
#include "client/cell/robots/pose_format.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using recognition::kMmPerM;
using recognition::Pose;

// Root mean square distance of the positions from their mean.
constexpr double kMinSpreadM = 0.005;
// No flange is that near to the origin of its robot's base at every pose.
constexpr double kWithinBaseM = 0.1;
constexpr double kFarthestFlangeM = 20;
// Relative error of a factor that counts, and the part of the factor that may be noise.
constexpr double kScaleTolerance = 0.2;
constexpr double kScaleNoise = 0.1;
// Of a pivot, relative to the largest: its square is far above the rounding.
constexpr double kRankThreshold = 1e-7;
// Deviations of the factor that it must differ from 1 by.
constexpr double kScaleDeviations = 4;
constexpr double kPositionNoiseM = 0.001;

constexpr char kUnitAdvice[] =
    "; are they in metres where millimetres are expected, or the other way round? Else move the "
    "flange and not only the tool's tip, in the frame of the robot's base";

// FAILED_PRECONDITION when the flange hardly moves, is always within the robot's base, or is
// farther away than any robot reaches. With poses on a sphere around the target nothing else shows
// that positions are a thousand times too small: the camera turns about the target, and the
// calibration would put the flange there.
absl::Status CheckFlangePositions(std::span<const HandEyeSample> samples) {
  Vector3d mean = Vector3d::Zero();
  double farthest = 0;
  for (const HandEyeSample& sample : samples) {
    const Vector3d at = sample.base_flange.translation();
    mean += at / static_cast<double>(samples.size());
    farthest = std::max(farthest, at.norm());
  }
  double squares = 0;
  for (const HandEyeSample& sample : samples) {
    squares += (sample.base_flange.translation() - mean).squaredNorm();
  }
  const double spread = std::sqrt(squares / static_cast<double>(samples.size()));
  if (farthest > kFarthestFlangeM) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "the flange's positions are up to %.0f m from the robot's base%s", farthest, kUnitAdvice));
  }
  if (spread < kMinSpreadM) {
    return absl::FailedPreconditionError(
        absl::StrFormat("the flange hardly moves: its positions differ by %.2f mm (root mean "
                        "square), at least %.0f "
                        "are needed%s",
                        kMmPerM * spread, kMmPerM * kMinSpreadM, kUnitAdvice));
  }
  if (farthest < kWithinBaseM) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "the flange never leaves the robot's base: its positions are within %.0f mm "
        "of the base's origin%s",
        kMmPerM * farthest, kUnitAdvice));
  }
  return absl::OkStatus();
}

// The factor by which the flange's positions are to be multiplied so that they fit the poses of the
// target: 1000 where metres were sent in place of millimetres. nullopt where the poses do not show
// it, or where it is about 1. `x_rotation`: of the camera, HandEyeSolution::x.
// With a factor s of the robot's translations, R_A t_Y - t_X + s t_A = R_X t_B is linear.
std::optional<double> WrongScaleOf(const std::vector<HandEyeEquation>& equations,
                                   const Eigen::Matrix3d& x_rotation) {
  constexpr Eigen::Index kUnknowns = 7;
  const auto rows = static_cast<Eigen::Index>(3 * equations.size());
  if (rows <= kUnknowns) return std::nullopt;
  Eigen::MatrixXd left(rows, kUnknowns);
  Eigen::VectorXd right(rows);
  Eigen::Index row = 0;
  for (const HandEyeEquation& equation : equations) {
    left.block<3, 3>(row, 0) = equation.a.linear();
    left.block<3, 3>(row, 3) = -Eigen::Matrix3d::Identity();
    left.block<3, 1>(row, 6) = equation.a.translation();
    right.segment<3>(row) = x_rotation * equation.b.translation();
    row += 3;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposed(rows, kUnknowns);
  decomposed.setThreshold(kRankThreshold);
  decomposed.compute(left);
  if (decomposed.rank() < kUnknowns) return std::nullopt;  // as on a sphere about the target
  const Eigen::VectorXd found = decomposed.solve(right);
  const double scale = found[6];
  const double variance =
      std::max(kPositionNoiseM * kPositionNoiseM,
               (left * found - right).squaredNorm() / static_cast<double>(rows - kUnknowns));
  const Eigen::MatrixXd information = left.transpose() * left;
  const Eigen::VectorXd last = Eigen::VectorXd::Unit(kUnknowns, 6);
  const double of_scale = information.ldlt().solve(last)[6];
  if (!(of_scale > 0) || !(scale > 0) || !std::isfinite(scale)) return std::nullopt;
  const double noise = std::sqrt(of_scale * variance) / scale;  // of the factor's logarithm
  if (noise > kScaleNoise) return std::nullopt;
  const double least = std::max(std::log1p(kScaleTolerance), kScaleDeviations * noise);
  if (std::abs(std::log(scale)) < least) return std::nullopt;
  return scale;
}

constexpr std::size_t kSubset = 4;
constexpr int kSubsets = 200;
// Minimum turn of the robot about each of two axes, root mean square over pairs.
constexpr double kMinTurnRad = 8 * recognition::kRadiansPerDegree;
// Standard deviation of the camera's position in any direction.
constexpr double kMaxWeakestM = 0.02;

using Equations = std::vector<HandEyeEquation>;

Equations EquationsOf(std::span<const HandEyeSample> samples, CameraMount mount) {
  Equations out;
  out.reserve(samples.size());
  for (const HandEyeSample& sample : samples) {
    const bool fixed = mount == CameraMount::kFixed;
    out.push_back({fixed ? sample.base_flange : sample.base_flange.inverse(), sample.camera_target,
                   mount, sample.covariance});
  }
  return out;
}

double CostOf(const Equations& equations, const HandEyeSolution& solution) {
  double cost = 0;
  for (const HandEyeEquation& equation : equations) {
    const double size = std::min(SizeOf(equation, solution), kMaxInlierSize);
    cost += size * size;
  }
  return cost;
}

HandEyeSolution SolveRobustly(const Equations& equations) {
  std::mt19937_64 random(1);
  HandEyeSolution best = SolveClosedForm(equations);
  double min_cost = CostOf(equations, best);
  std::vector<std::size_t> order(equations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (int i = 0; i < kSubsets; ++i) {
    Equations some;
    for (std::size_t k = 0; k < kSubset; ++k) {
      std::swap(order[k], order[k + random() % (order.size() - k)]);
      some.push_back(equations[order[k]]);
    }
    const HandEyeSolution solution = SolveClosedForm(some);
    const double cost = CostOf(equations, solution);
    if (cost >= min_cost) continue;
    min_cost = cost;
    best = solution;
  }
  return best;
}

// The robot's turn about the second of its main axes.
double SecondTurn(const Equations& equations) {
  Matrix3d moments = Matrix3d::Zero();
  double pairs = 0;
  for (std::size_t i = 0; i < equations.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j, ++pairs) {
      const Vector3d turn =
          RotationVector(equations[j].a.linear() * equations[i].a.linear().transpose());
      moments += turn * turn.transpose();
    }
  }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(moments / pairs).eigenvalues()[1]);
}

absl::Status CheckTurns(const Equations& equations) {
  const double turn = SecondTurn(equations);
  if (turn >= kMinTurnRad) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "the poses are too similar: the robot turned by %.1f degrees about a second axis, at least "
      "%.0f are needed; tilt the tool to different sides",
      turn / recognition::kRadiansPerDegree, kMinTurnRad / recognition::kRadiansPerDegree));
}

// For the end of an error about poses that do not agree.
std::string ScaleHint(const Equations& equations) {
  const auto scale = WrongScaleOf(equations, SolveClosedForm(equations).x.linear());
  if (!scale) return "";
  return absl::StrFormat(
      " They would agree if its positions were multiplied by %.3g: check their unit.", *scale);
}

absl::Status CheckCertainty(const Equations& used, const HandEye& found) {
  if (found.certainty.weakest_m > kMaxWeakestM) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "the poses leave the camera's position uncertain by %.0f mm in one direction, at most %.0f "
        "are accepted; tilt the tool more, to different sides, and change the distance",
        recognition::kMmPerM * found.certainty.weakest_m, recognition::kMmPerM * kMaxWeakestM));
  }
  const auto scale = WrongScaleOf(used, found.mount_camera.linear());
  if (!scale) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "the flange's positions fit the target's if they are multiplied by %.3g; check their unit, "
      "and the camera's",
      *scale));
}

std::vector<HandEyeResidual> ResidualsOf(const Equations& equations,
                                         const HandEyeSolution& solution) {
  std::vector<HandEyeResidual> out;
  out.reserve(equations.size());
  for (const HandEyeEquation& equation : equations) {
    const Vector6d error = ErrorOf(equation, solution);
    out.push_back({.shift_m = error.tail<3>().norm(),
                   .turn_rad = error.head<3>().norm(),
                   .used = SizeOf(equation, solution) < kMaxInlierSize});
  }
  return out;
}

}  // namespace

absl::StatusOr<HandEye> SolveHandEye(std::span<const HandEyeSample> samples, CameraMount mount) {
  const Equations all = EquationsOf(samples, mount);
  if (all.size() < kMinHandEyeSamples) {
    return absl::FailedPreconditionError(
        absl::StrCat("there are ", all.size(), " poses with the target in view, at least ",
                     kMinHandEyeSamples, " are needed; add poses"));
  }
  RETURN_IF_ERROR(CheckTurns(all));
  RETURN_IF_ERROR(CheckFlangePositions(samples));
  const HandEyeSolution solution = Refine(all, SolveRobustly(all)).solution;
  HandEye out;
  out.mount_camera = solution.x;
  out.mount_target = solution.y;
  out.residuals = ResidualsOf(all, solution);
  Equations used;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const HandEyeResidual& residual = out.residuals[i];
    if (!residual.used) continue;
    used.push_back(all[i]);
    out.shift_m += residual.shift_m * residual.shift_m;
    out.turn_rad += residual.turn_rad * residual.turn_rad;
  }
  if (2 * used.size() < all.size()) {
    return absl::FailedPreconditionError(absl::StrCat(
        "only ", used.size(), " of ", all.size(),
        " poses agree with each other; is the target firmly gripped or fixed, and always "
        "recognised? Are the flange's poses in the robot's base frame, and in the format that is "
        "sent?",
        ScaleHint(all)));
  }
  if (used.size() < kMinHandEyeSamples) {
    return absl::FailedPreconditionError(absl::StrCat(
        "only ", used.size(), " of ", all.size(), " poses agree with each other, at least ",
        kMinHandEyeSamples, " are needed; add poses, and check that the target does not move"));
  }
  RETURN_IF_ERROR(CheckTurns(used));
  const auto count = static_cast<double>(used.size());
  out.shift_m = std::sqrt(out.shift_m / count);
  out.turn_rad = std::sqrt(out.turn_rad / count);
  out.certainty = CertaintyOf(used, solution);
  RETURN_IF_ERROR(CheckCertainty(used, out));
  return out;
}

std::vector<HandEyeResidual> CheckHandEye(std::span<const HandEyeSample> samples, CameraMount mount,
                                          const Pose& mount_camera, const Pose& mount_target) {
  return ResidualsOf(EquationsOf(samples, mount), {mount_camera, mount_target});
}

}  // namespace graspdb::client
