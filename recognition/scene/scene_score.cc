#include "recognition/scene/scene_score.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace graspdb::recognition {
namespace {

float Above(float value, float limit) { return std::max(0.0F, value - limit); }

// The logarithm of enough / there; 0 where there is enough, at most that of 1 / `least`.
float Lack(float there, float enough, float least) {
  return -std::log(std::clamp(there / enough, least, 1.0F));
}

}  // namespace

float SceneScore(const Frame& frame, const SceneHypothesis& hypothesis,
                 const ImageEvidenceParameters& parameters, const SceneScoreWeights& weights) {
  const SurfaceEvidence& s = hypothesis.surface;
  const OutlineEvidence& o = hypothesis.outline;
  const float measured = std::max(1e-3F, s.seen + s.contradicted + s.table);
  const float z = hypothesis.sensor_object.translation().z();
  const float tolerance = ToleranceAt(frame, z, parameters);
  constexpr std::size_t kFewestOutline = 5;
  // Where most of a low object looks like the table, what the rest says counts less.
  const float judgeable = std::min(1.0F, (s.seen + s.contradicted) / 0.5F);
  float against = 0;
  against += weights.behind * std::min(0.4F, Above((s.contradicted - s.tilted) / measured, 0.05F));
  against += weights.tilted * Above(s.tilted / measured, 0.03F);
  against += weights.table * Above(s.table / measured, 0.05F);
  against += weights.bend * judgeable * Above(s.bend, 0.03F);
  against += weights.unmeasured * Above(s.unmeasured, 0.2F);
  against += weights.covered * s.covered;
  against += weights.hidden * Above(s.hidden - s.covered, 0.2F);
  against += weights.unseen * Lack(s.seen, 0.7F, 0.05F);
  // Where the table is measured, an outline that is hardly known is suspect by itself.
  const float little = frame.table ? 0.5F : 0.0F;
  against +=
      weights.smooth * judgeable * Above(o.count < kFewestOutline ? little : o.smooth, 0.05F);
  against += weights.unknown * judgeable * Above(o.unknown, 0.35F);
  against += weights.little_outline * Lack(static_cast<float>(o.count), 20, 0.1F);
  against += weights.residual * Above(s.rms_m / tolerance, 0.3F);
  if (const std::optional<float> clearance = hypothesis.clearance_m) {
    against += weights.floating * std::min(1.0F, Above(*clearance, 0.012F) / 0.05F);
    against += weights.sunk * std::min(1.0F, Above(-*clearance, 0.010F) / 0.03F);
  }
  against += weights.information * Lack(hypothesis.information, 0.6F, 0.05F);
  against += weights.area * Lack(s.seen_area_m2, 0.004F, 0.03F);
  return weights.offset - against;
}

double ProposalScore(float log_odds, float lead, float seen_area_m2,
                     const ProposalWeights& weights) {
  constexpr float kSmallestM2 = 1e-4F;
  constexpr double kAreaM2 = 0.004;
  const double sum = weights.offset + weights.image * log_odds +
                     weights.lead * std::clamp<double>(lead, weights.min_lead, weights.max_lead) +
                     weights.area * std::log(std::max(seen_area_m2, kSmallestM2) / kAreaM2);
  return 1 / (1 + std::exp(-sum));
}

}  // namespace graspdb::recognition
