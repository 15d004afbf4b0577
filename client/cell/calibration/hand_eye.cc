#include "client/cell/calibration/hand_eye.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cell/calibration/flange_positions.h"
#include "client/cell/calibration/hand_eye_equation.h"
#include "client/cell/robots/rotation_vector.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using recognition::Pose;

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
