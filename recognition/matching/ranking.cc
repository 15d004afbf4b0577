#include "recognition/matching/ranking.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "recognition/simd/rigid_transform.h"

namespace graspdb::recognition {
namespace {

// A measurement matches a surface up to this many deviations away; a good alignment leaves the
// deviation of the sensor and of the voxels. At least kMinToleranceM, m. Chosen (ADR 9); not
// measured alone. With twice the number the support distance of 8 mm is reached at a deviation of
// 0.9 mm, and with twice the minimum nearly so at any: then objects that differ by some mm score
// alike.
constexpr double kEvidenceDeviations = 4.5;
constexpr double kMinToleranceM = 0.0035;
// Surfaces that are nowhere farther apart are the same, m, or as a share of the diameter. Chosen;
// not measured alone. Doubled, surfaces of an object that are 6 to 12 mm apart count as one, and
// such poses are no longer listed as ambiguous.
constexpr double kSameSurfaceM = 0.006;
constexpr double kSameSurfaceShare = 0.04;
// Scores (0 to 1) that differ less are equal. Chosen (ADR 9); not measured alone. Doubled, more
// detections are AMBIGUOUS.
constexpr double kEqualScores = 0.006;

// Infinite outside of the grid of `to`, which reaches 21 mm: no part is so large that this is the
// same surface.
double LargestGapTo(const SurfaceModel& from, const Pose& to_from, const SurfaceModel& to) {
  const RigidTransform moved(to_from);
  double largest = 0;
  for (const Eigen::Vector3f& point : from.coarse.cloud.points) {
    const Eigen::Vector3f p = moved.Point(point);
    const int nearest = to.grid.Nearest(p);
    if (nearest < 0) return std::numeric_limits<double>::infinity();
    const Eigen::Vector3f d = p - to.fine.cloud.points[static_cast<std::size_t>(nearest)];
    largest = std::max(largest, static_cast<double>(d.norm()));
  }
  return largest;
}

// A turn from one pose to the other that the declared symmetry allows, `tolerance_m` at the rim.
bool IsDeclaredTurn(const PoseHypothesis& a, const PoseHypothesis& b, double tolerance_m) {
  if (a.view->stable_pose != b.view->stable_pose || a.symmetry_order == 1) return false;
  const Pose between = a.refined.inverse() * b.refined;
  const Eigen::Matrix3d& r = between.linear();
  double turn = std::atan2(r(1, 0), r(0, 0));
  if (a.symmetry_order > 1) {
    const double step = 2 * std::numbers::pi / a.symmetry_order;
    turn = step * std::round(turn / step);
  }
  const Eigen::AngleAxisd rest(Eigen::AngleAxisd(-turn, Eigen::Vector3d::UnitZ()) * r);
  return between.translation().norm() +
             std::abs(rest.angle()) * static_cast<double>(a.model->radius_m) <
         tolerance_m;
}

RankClass RankClassOf(const PoseHypothesis& h, const PoseHypothesis& best) {
  const double same =
      std::max(kSameSurfaceM, kSameSurfaceShare * 2 * static_cast<double>(best.model->radius_m));
  if (IsDeclaredTurn(best, h, same)) return RankClass::kSameSurface;
  if (h.view->object == best.view->object &&
      LargestGap(*best.model, best.refined, *h.model, h.refined) < same) {
    return RankClass::kSameSurface;
  }
  return h.close_score > best.close_score - kEqualScores ? RankClass::kAsGood : RankClass::kWorse;
}

}  // namespace

void RankClosely(const SoaCloud& segment, const DepthBuffer& depth_buffer,
                 double support_distance_m, std::vector<PoseHypothesis>* hypotheses) {
  if (hypotheses->empty()) return;
  const double tolerance =
      std::clamp(kEvidenceDeviations * hypotheses->front().evidence.rms_m,
                 std::min(kMinToleranceM, support_distance_m), support_distance_m);
  for (PoseHypothesis& h : *hypotheses) {
    h.close_score =
        Verify(*h.model, h.refined, segment, depth_buffer, {.tolerance_m = tolerance}).score;
  }
  std::ranges::stable_sort(*hypotheses, std::greater(), &PoseHypothesis::close_score);
  PoseHypothesis& best = hypotheses->front();
  for (PoseHypothesis& h : *hypotheses) h.rank_class = RankClassOf(h, best);
  best.rank_class = RankClass::kBest;
}

double LargestGap(const SurfaceModel& a, const Pose& world_a, const SurfaceModel& b,
                  const Pose& world_b) {
  const Pose b_a = world_b.inverse() * world_a;
  return std::max(LargestGapTo(a, b_a, b), LargestGapTo(b, b_a.inverse(), a));
}

}  // namespace graspdb::recognition
