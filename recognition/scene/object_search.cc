#include "recognition/scene/object_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_map>

#include "recognition/points/cell_key.h"

namespace graspdb::recognition {
namespace {

// Poses that differ by less are one: shares of the diameter and a turn, rad.
constexpr float kSamePlaceShare = 0.05F;
constexpr float kSameTurnRad = 0.17F;
constexpr std::size_t kComparedPoints = 24;
// What is no lower than this under the table may stand on it: the table's noise, m.
constexpr float kTableNoiseM = 0.010F;

struct Candidate {
  Eigen::Isometry3f pose;
  float score = 0;
};

bool IsSame(const PairModel& model, const Eigen::Isometry3f& a, const Eigen::Isometry3f& b) {
  if ((a * model.center - b * model.center).norm() > kSamePlaceShare * model.diameter_m) {
    return false;
  }
  const Eigen::AngleAxisf turn(Eigen::Matrix3f(a.linear().transpose() * b.linear()));
  if (std::abs(turn.angle()) < kSameTurnRad) return true;
  // Turns of a symmetric object.
  const Points& points = model.points.points;
  const Eigen::Isometry3f b_a = b.inverse() * a;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kComparedPoints);
  float sum = 0;
  float count = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Eigen::Vector3f p = b_a * points[i];
    float nearest = model.diameter_m * model.diameter_m;
    for (const auto& q : points) nearest = std::min(nearest, (q - p).squaredNorm());
    sum += std::sqrt(nearest);
    count += 1;
  }
  // Even a surface on itself is half a step off.
  return sum < count * (0.5F * model.step_m + kSamePlaceShare * model.diameter_m / 2);
}

// The best that score enough, the best first; without those that are the pose of a better one where
// `distinct`.
void Select(const SelectionParameters& parameters, const PairModel& model, bool distinct,
            std::vector<Candidate>* candidates) {
  std::ranges::stable_sort(*candidates, std::greater(), &Candidate::score);
  std::unordered_map<std::uint64_t, std::size_t> taken;
  std::vector<Candidate> kept;
  for (const Candidate& c : *candidates) {
    if (kept.size() == parameters.count || c.score < parameters.min_score) break;
    const auto is_known = [&](const Candidate& k) { return IsSame(model, k.pose, c.pose); };
    if (distinct && std::ranges::any_of(kept, is_known)) continue;
    std::size_t& here = taken[CellKey(c.pose * model.center, model.diameter_m / 2)];
    if (here == parameters.at_one_place) continue;
    here += 1;
    kept.push_back(c);
  }
  *candidates = std::move(kept);
}

float ClearanceFactor(std::optional<float> clearance_m) {
  constexpr float kFadesOverM = 0.01F;
  const float below = std::max(0.0F, -clearance_m.value_or(0) - kTableNoiseM);
  return std::exp(-below / kFadesOverM);
}

std::optional<float> ClearanceAt(const Frame& frame, const ImageModel& model,
                                 const Eigen::Isometry3f& sensor_object) {
  if (!frame.table) return std::nullopt;
  return ClearanceOver(*frame.table, model, sensor_object);
}

float ScoreOf(const SurfaceEvidence& surface, const OutlineEvidence& outline,
              std::optional<float> clearance_m) {
  constexpr std::size_t kFewest = 5;
  const float ends = outline.count < kFewest ? 0.9F : 1 - 0.6F * outline.smooth;
  return surface.Score() * ends * ClearanceFactor(clearance_m);
}

// A look from the nearest stored aspect.
float Glance(const Frame& frame, const PairModel& model, const Eigen::Isometry3f& pose,
             const SelectionParameters& parameters, const ImageEvidenceParameters& evidence) {
  const ModelAspect& aspect = AspectAt(model, pose);
  return ScoreOf(LookAtSurface(frame, model, aspect, pose, parameters.points,
                               parameters.tolerance_factor, evidence),
                 LookAtOutline(frame, aspect, pose, evidence), ClearanceAt(frame, model, pose));
}

}  // namespace

OrientedCloud ObjectPoints(const Frame& frame) {
  OrientedCloud out;
  for (std::size_t i = 0; i < frame.role.size(); ++i) {
    if (frame.role[i] != PixelRole::kObject || frame.normals[i].squaredNorm() == 0) continue;
    out.points.push_back(frame.PointAt(i, frame.depth[i]));
    out.normals.push_back(frame.normals[i]);
  }
  return out;
}

SceneHypothesis JudgePose(const Frame& frame, const ImageModel& model,
                          const Eigen::Isometry3f& sensor_object,
                          const ObjectSearchParameters& parameters) {
  SceneHypothesis out;
  out.sensor_object = sensor_object;
  const ModelAspect aspect =
      model.AspectSeenFrom(sensor_object.inverse().translation(), parameters.judged_outline_points);
  out.surface = LookAtSurface(frame, model, aspect, sensor_object, parameters.judged_points, 1,
                              parameters.evidence);
  out.outline = LookAtOutline(frame, aspect, sensor_object, parameters.evidence);
  out.clearance_m = ClearanceAt(frame, model, sensor_object);
  out.information = InformationOf(frame, model, aspect, sensor_object, parameters.last_steps);
  out.score = ScoreOf(out.surface, out.outline, out.clearance_m);
  return out;
}

std::vector<SceneHypothesis> SearchObject(const Frame& frame, const PairModel& model,
                                          const VotedPoses& voted,
                                          const ObjectSearchParameters& parameters,
                                          const IsCancelled& is_cancelled,
                                          const SearchObserver& observer) {
  const auto observe = [&](PoseStep step, const auto& all, auto pose) {
    if (!observer) return;
    std::vector<Eigen::Isometry3f> poses;
    std::ranges::transform(all, std::back_inserter(poses), pose);
    observer(step, poses);
  };
  std::vector<Candidate> candidates;
  const SelectionParameters& check = parameters.checked;
  for (const Eigen::Isometry3f& pose : voted) {
    const SurfaceEvidence look =
        LookAtSurface(frame, model, AspectAt(model, pose), pose, check.points,
                      check.tolerance_factor, parameters.evidence);
    candidates.push_back({pose, look.Score()});
  }
  observe(PoseStep::kProposed, candidates, &Candidate::pose);
  Select(check, model, /*distinct=*/false, &candidates);
  observe(PoseStep::kKept, candidates, &Candidate::pose);
  const auto align = [&](const ImageRefinementParameters& steps,
                         const SelectionParameters& selection) {
    for (Candidate& c : candidates) {
      c.pose = RefineInImage(frame, model, c.pose, steps);
      c.score = Glance(frame, model, c.pose, selection, parameters.evidence);
    }
    Select(selection, model, /*distinct=*/true, &candidates);
  };
  if (is_cancelled()) return {};
  align(parameters.first_steps, parameters.screened);
  if (is_cancelled()) return {};
  align(parameters.last_steps, parameters.refined);
  std::vector<SceneHypothesis> out;
  out.reserve(candidates.size());
  for (const Candidate& c : candidates) {
    out.push_back(JudgePose(frame, model, c.pose, parameters));
  }
  std::ranges::stable_sort(out, std::greater(), &SceneHypothesis::score);
  observe(PoseStep::kRefined, out, &SceneHypothesis::sensor_object);
  return out;
}

}  // namespace graspdb::recognition
