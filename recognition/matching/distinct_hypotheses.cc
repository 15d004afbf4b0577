#include "recognition/matching/distinct_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace graspdb::recognition {
namespace {

// Poses of a model that are nearer than both, m at its centre and rad, are one. Chosen; not
// measured alone. Doubled, fewer hypotheses are refined; the worse of two minima that are 4 to 8 mm
// or 4 to 8 degrees apart is dropped, and is missing where it is the right one.
constexpr double kSamePlaceM = 0.004;
constexpr double kSameTurnRad = 4 * std::numbers::pi / 180;

bool IsSamePlace(const SurfaceModel& model, const Pose& a, const Pose& b) {
  const Pose difference = a.inverse() * b;
  const Eigen::Vector3d center = model.center.cast<double>();
  return (difference * center - center).norm() < kSamePlaceM &&
         std::abs(Eigen::AngleAxisd(difference.linear()).angle()) < kSameTurnRad;
}

}  // namespace

bool IsThere(const PoseHypothesis& a, const Pose& pose, const PoseHypothesis& b) {
  // Not by pointers: a model dropped from a cache is loaded again at another address.
  return HaveSameModel(*a.view, *b.view) && IsSamePlace(*a.model, pose, b.refined);
}

void KeepBest(std::size_t count, std::vector<PoseHypothesis>* hypotheses) {
  std::stable_sort(hypotheses->begin(), hypotheses->end(),
                   [](const PoseHypothesis& a, const PoseHypothesis& b) {
                     return a.evidence.score > b.evidence.score;
                   });
  std::vector<PoseHypothesis> different;
  for (PoseHypothesis& h : *hypotheses) {
    const auto same = [&](const auto& other) { return IsThere(h, h.refined, other); };
    if (std::ranges::any_of(different, same)) continue;
    different.push_back(std::move(h));
    if (different.size() == count) break;
  }
  *hypotheses = std::move(different);
}

}  // namespace graspdb::recognition
