#include "client/cell/calibration/flange_positions.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::kMmPerM;

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

}  // namespace

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

}  // namespace graspdb::client
