#include "recognition/scene/object_search.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "recognition/points/cell_key.h"

namespace graspdb::recognition {
namespace {

// Poses that differ by less are one: shares of the diameter and a turn, rad.
constexpr float kSamePlaceShare = 0.05F;
constexpr float kSameTurnRad = 0.17F;
constexpr std::size_t kComparedPoints = 24;
// Points below the table that are its noise, m.
constexpr float kTablePenetrationM = 0.010F;
constexpr std::size_t kAllPoints = 400;
constexpr std::size_t kOutlinePoints = 96;

struct Candidate {
  Eigen::Isometry3f pose;
  float score = 0;
};

void Sort(std::vector<Candidate>* candidates) {
  std::ranges::stable_sort(*candidates, std::greater(), &Candidate::score);
}

// The best, and at most `at_one_place` whose centres are in one cell of half a diameter: a large
// neighbour that explains a model badly in a hundred ways must not end the search elsewhere.
void KeepBest(std::size_t count, std::size_t at_one_place, const PairModel& model,
              std::vector<Candidate>* candidates) {
  Sort(candidates);
  std::unordered_map<std::uint64_t, std::size_t> taken;
  std::vector<Candidate> kept;
  for (const Candidate& c : *candidates) {
    if (kept.size() == count) break;
    if (taken[CellKey(c.pose * model.center, model.diameter_m / 2)]++ >= at_one_place) continue;
    kept.push_back(c);
  }
  *candidates = std::move(kept);
}

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
    float nearest = model.diameter_m;
    for (const auto& q : points) nearest = std::min(nearest, (q - p).squaredNorm());
    sum += std::sqrt(nearest);
    count += 1;
  }
  // Even a surface on itself is half a step off.
  return sum < count * (0.5F * model.step_m + kSamePlaceShare * model.diameter_m / 2);
}

// Without those that another, better one says the same of. `candidates` are sorted.
void DropSame(const PairModel& model, std::vector<Candidate>* candidates) {
  std::vector<Candidate> kept;
  for (const Candidate& c : *candidates) {
    if (std::ranges::any_of(kept,
                            [&](const Candidate& k) { return IsSame(model, k.pose, c.pose); }))
      continue;
    kept.push_back(c);
  }
  *candidates = std::move(kept);
}

float OutlineFactor(const OutlineEvidence& outline) {
  return outline.count < 5 ? 0.9F : 1 - 0.6F * outline.smooth;
}

float HeightFactor(const Frame& frame, const HeightRange& heights) {
  if (!frame.table) return 1;
  const float below = std::max(0.0F, -heights.low - kTablePenetrationM);
  return std::exp(-below / 0.01F);
}

}  // namespace

OrientedCloud SceneSample(const Frame& frame, float cell_m) {
  std::unordered_map<std::uint64_t, std::size_t> cells;
  OrientedCloud out;
  std::vector<float> counts;
  for (int v = 0; v < frame.camera.height; ++v) {
    for (int u = 0; u < frame.camera.width; ++u) {
      const std::size_t i = frame.PixelAt(u, v);
      if (frame.role[i] != PixelRole::kObject || frame.normals[i].squaredNorm() == 0) continue;
      const Eigen::Vector3f p = frame.PointAt(u, v, frame.depth[i]);
      const auto [cell, is_new] = cells.try_emplace(CellKey(p, cell_m), out.points.size());
      if (is_new) {
        out.points.push_back(p);
        out.normals.push_back(frame.normals[i]);
        counts.push_back(1);
      } else {
        out.points[cell->second] += p;
        out.normals[cell->second] += frame.normals[i];
        counts[cell->second] += 1;
      }
    }
  }
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    out.points[i] /= counts[i];
    out.normals[i].normalize();
  }
  return out;
}

SceneHypothesis JudgePose(const Frame& frame, const PairModel& model,
                          const Eigen::Isometry3f& sensor_object,
                          const ObjectSearchParameters& parameters) {
  SceneHypothesis out;
  out.sensor_object = sensor_object;
  const ModelAspect aspect = model.AspectSeenFrom(
      -(sensor_object.linear().transpose() * sensor_object.translation()), kOutlinePoints);
  out.surface =
      LookAtSurface(frame, model, aspect, sensor_object, kAllPoints, 1, parameters.evidence);
  out.outline = LookAtOutline(frame, aspect, sensor_object, parameters.evidence);
  out.information = InformationOf(frame, model, aspect, sensor_object, parameters.last_steps);
  if (frame.table) out.heights = HeightsOver(*frame.table, model, sensor_object);
  out.score = out.surface.Score() * OutlineFactor(out.outline) * HeightFactor(frame, out.heights);
  return out;
}

std::vector<SceneHypothesis> SearchObject(const Frame& frame, const OrientedCloud& sample,
                                          const PairModel& model,
                                          const ObjectSearchParameters& parameters,
                                          const IsCancelled& is_cancelled) {
  std::vector<Candidate> candidates;
  for (const Eigen::Isometry3f& pose : VotedPoses(model, sample, parameters.votes, is_cancelled)) {
    const SurfaceEvidence look = LookAtSurface(frame, model, AspectAt(model, pose), pose,
                                               parameters.check_points, 2, parameters.evidence);
    if (look.Score() >= parameters.min_checked_score) candidates.push_back({pose, look.Score()});
  }
  KeepBest(parameters.screened_count, parameters.screened_at_one_place, model, &candidates);
  if (is_cancelled()) return {};
  const auto glance = [&](Candidate* c, std::size_t points, float tolerance_factor) {
    const ModelAspect& aspect = AspectAt(model, c->pose);
    c->score =
        LookAtSurface(frame, model, aspect, c->pose, points, tolerance_factor, parameters.evidence)
            .Score() *
        OutlineFactor(LookAtOutline(frame, aspect, c->pose, parameters.evidence));
    if (frame.table) c->score *= HeightFactor(frame, HeightsOver(*frame.table, model, c->pose));
  };
  const auto drop_below = [&](float score) {
    std::erase_if(candidates, [&](const Candidate& c) { return c.score < score; });
  };
  for (Candidate& c : candidates) {
    c.pose = RefineInImage(frame, model, c.pose, parameters.first_steps).sensor_object;
    glance(&c, 64, 1.5F);
  }
  drop_below(parameters.min_refined_score);
  Sort(&candidates);
  DropSame(model, &candidates);
  KeepBest(parameters.refined_count, parameters.refined_at_one_place, model, &candidates);
  if (is_cancelled()) return {};
  for (Candidate& c : candidates) {
    c.pose = RefineInImage(frame, model, c.pose, parameters.last_steps).sensor_object;
    glance(&c, 160, 1);
  }
  drop_below(parameters.min_kept_score);
  Sort(&candidates);
  DropSame(model, &candidates);
  KeepBest(parameters.kept_count, parameters.kept_at_one_place, model, &candidates);
  std::vector<SceneHypothesis> out;
  out.reserve(candidates.size());
  for (const Candidate& c : candidates) out.push_back(JudgePose(frame, model, c.pose, parameters));
  std::ranges::stable_sort(out, std::greater(), &SceneHypothesis::score);
  return out;
}

}  // namespace graspdb::recognition
