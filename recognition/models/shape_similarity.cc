#include "recognition/models/shape_similarity.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// See AlikeM and NearlyAlikeM, and ADR 10 for where they come from.
constexpr double kAlikeM = 0.0025;
constexpr double kAlikeShare = 0.02;  // of the diameter
constexpr double kNearly = 2;         // times as much
// The most that is alike: twice as much is less than kFarM, beyond which no gap is measured.
constexpr double kMaxAlikeM = 0.009;
constexpr double kGapShare = 0.95;
// Distance of points outside a model's grid, m.
constexpr float kFarM = 0.02F;
constexpr int kIterations = 12;
constexpr int kMaxFold = 12;
constexpr int kAnyTurns = 36;      // tried for a round object
constexpr int kPairTurns = 24;     // tried for two objects
constexpr double kSameSize = 0.9;  // of the radius; others are not compared

// About the vertical through the centre of `a`, which goes to that of `b`; both stand on z = 0.
Pose TurnedOnto(const SurfaceModel& a, const SurfaceModel& b, double turn_rad) {
  Pose out = Pose::Identity();
  out.rotate(Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()));
  out.translation() = b.center.cast<double>() - out.linear() * a.center.cast<double>();
  out.translation().z() = 0;
  return out;
}

// Gauss and Newton over the table, on distances to tangent planes; without `may_turn` the turn
// stays.
Pose SlideOnto(const SurfaceModel& a, const SurfaceModel& b, Pose b_a, bool may_turn) {
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::Isometry3f forth = b_a.cast<float>();
    const Vector3f center = forth * a.center;
    Eigen::Matrix3d hessian = 1e-9 * Eigen::Matrix3d::Identity();
    Vector3d gradient = Vector3d::Zero();
    for (std::size_t i = 0; i < a.coarse.cloud.points.size(); ++i) {
      const Vector3f p = forth * a.coarse.cloud.points[i];
      const int nearest = b.grid.Nearest(p);
      if (nearest < 0) continue;
      const auto at = static_cast<std::size_t>(nearest);
      const Vector3f& normal = b.fine.cloud.normals[at];
      if (normal.dot(forth.linear() * a.coarse.cloud.normals[i]) < 0.5F) continue;
      const Vector3f arm = p - center;
      const Vector3d row(static_cast<double>(normal.x()), static_cast<double>(normal.y()),
                         may_turn ? static_cast<double>(arm.cross(normal).z()) : 0.0);
      const double residual = static_cast<double>((b.fine.cloud.points[at] - p).dot(normal));
      hessian += row * row.transpose();
      gradient += residual * row;
    }
    if (!may_turn) hessian(2, 2) = 1;
    const Vector3d step = hessian.ldlt().solve(gradient);
    const Vector3d c = center.cast<double>();
    const Eigen::AngleAxisd turn(step.z(), Vector3d::UnitZ());
    b_a = Eigen::Translation3d(c + Vector3d(step.x(), step.y(), 0)) * turn *
          Eigen::Translation3d(-c) * b_a;
  }
  return b_a;
}

void AddDistances(const SurfaceModel& from, const SurfaceModel& to, const Pose& to_from,
                  std::vector<float>* distances) {
  const Eigen::Isometry3f moved = to_from.cast<float>();
  for (const Vector3f& p : from.coarse.cloud.points) {
    distances->push_back(std::min(kFarM, to.DistanceTo(moved * p)));
  }
}

Gap GapOf(const SurfaceModel& a, const SurfaceModel& b, const Pose& b_a) {
  std::vector<float> distances;
  distances.reserve(a.coarse.cloud.points.size() + b.coarse.cloud.points.size());
  AddDistances(a, b, b_a, &distances);
  AddDistances(b, a, b_a.inverse(), &distances);
  Gap out;
  if (distances.empty()) return {kFarM, kFarM};
  for (const float d : distances) out.mean_m += static_cast<double>(d);
  out.mean_m /= static_cast<double>(distances.size());
  const auto rank = distances.begin() + static_cast<std::ptrdiff_t>(
                                            kGapShare * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), rank, distances.end());
  out.largest_m = static_cast<double>(*rank);
  return out;
}

// The largest gap of the turns by `count`-ths of a whole one; gives up beyond `limit_m`.
Gap GapOfTurns(const SurfaceModel& model, int count, double limit_m) {
  Gap worst;
  for (int k = 1; k < count && worst.largest_m <= limit_m; ++k) {
    const double turn = 2 * std::numbers::pi * k / count;
    const Gap gap =
        GapOf(model, model, SlideOnto(model, model, TurnedOnto(model, model, turn), false));
    if (gap.largest_m > worst.largest_m) worst = gap;
  }
  return worst;
}

}  // namespace

double AlikeM(const SurfaceModel& model) {
  return std::clamp(kAlikeShare * 2 * static_cast<double>(model.radius_m), kAlikeM, kMaxAlikeM);
}

double NearlyAlikeM(const SurfaceModel& model) { return kNearly * AlikeM(model); }

FoundSymmetry FindSymmetry(const SurfaceModel& model) {
  for (const bool nearly : {false, true}) {
    const double limit = nearly ? NearlyAlikeM(model) : AlikeM(model);
    const Gap any = GapOfTurns(model, kAnyTurns, limit);
    if (any.largest_m <= limit) return {0, nearly, any};
    for (int order = kMaxFold; order > 1; --order) {
      const Gap gap = GapOfTurns(model, order, limit);
      if (gap.largest_m <= limit) return {order, nearly, gap};
    }
  }
  return {};
}

std::optional<ShapeSimilarity> FindShapeSimilarity(const SurfaceModel& a, const SurfaceModel& b) {
  if (std::min(a.radius_m, b.radius_m) < kSameSize * std::max(a.radius_m, b.radius_m)) {
    return std::nullopt;
  }
  const double limit = std::max(NearlyAlikeM(a), NearlyAlikeM(b));
  if (std::abs(static_cast<double>(a.center.z() - b.center.z())) > limit) return std::nullopt;
  std::optional<ShapeSimilarity> best;
  for (int k = 0; k < kPairTurns; ++k) {
    const double turn = 2 * std::numbers::pi * k / kPairTurns;
    const Pose b_a = SlideOnto(a, b, TurnedOnto(a, b, turn), true);
    const Gap gap = GapOf(a, b, b_a);
    if (gap.largest_m > limit || (best && best->gap.largest_m <= gap.largest_m)) continue;
    best = {b_a, gap};
  }
  return best;
}

}  // namespace graspdb::recognition
