// Screening of views and their initial poses.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <unordered_map>
#include <vector>

#include "recognition/base/idle_cores.h"
#include "recognition/base/top_scores.h"
#include "recognition/matching/rough_pose.h"
#include "recognition/matching/segment_matcher.h"

namespace graspdb::recognition {
namespace {

// Of views that show a model in turns less apart than this, as from other heights, one is tried.
// With 20 degrees, every other one of views that are taught every 15, two of 96 scenes with
// touching objects were lost.
inline constexpr double kTriedTurnRad = 14 * std::numbers::pi / 180;

class TriedTurns {
 public:
  // False for a view of a model that was added in nearly the same turn: a glance at either leads to
  // the same place.
  bool Add(const TaughtView& view, const SeenSegment& segment) {
    std::vector<double>& known = of_model_[view.shares_frame ? view.stable_pose : view.name];
    const double turn = TurnOf(view, segment);
    const auto is_near = [&](double other) {
      return std::abs(std::remainder(turn - other, 2 * std::numbers::pi)) < kTriedTurnRad;
    };
    if (std::ranges::any_of(known, is_near)) return false;
    known.push_back(turn);
    return true;
  }

 private:
  std::unordered_map<std::string, std::vector<double>> of_model_;
};

// Views screened between polls of cancellation and the clock; 2 ms.
constexpr std::size_t kScreenedAtOnce = 64;
// A glance: whether a model may fit the segment at all. Without edges, which flat objects need only
// at the end. The reach shrinks as in the first two of kRoughSteps. Chosen; not measured alone.
// With twice the iterations the refinement, three fifths of a glance (ADR 27), takes twice as long.
constexpr RefinementOptions kGlanceSteps = {.iterations = 2,
                                            .first_reach_m = 0.02,
                                            .last_reach_m = 0.0167,
                                            .coarse = true,
                                            .edges = false,
                                            .height_deviation_m = 1e-4,
                                            .tilt_deviation_rad = 1e-3};
// Tolerance before any refinement, m: as far as correspondences reach.
constexpr double kUnrefinedToleranceM = 0.02;
// Initial poses that explain less than this share of the best one get no glance: 55 % of them on
// real frames, with 3 % of those that would have been refined after it. With 0.5 it is 64 and 5 %,
// with 0.3 45 and 1 %.
constexpr double kUnrefinedShare = 0.4;
// Starts below this share of the best score after a glance are not tried; in 96 scenes with 40 %
// hidden the final best had at least 0.69.
constexpr double kTriedShare = 0.6;
// Nor those that score lower than this: see kExplainsLittle.
constexpr double kMinGlance = 0.35;
// A model that can explain no more of the segment has a score below 0.5, which never was the best
// in the scenes with 40 % hidden.
constexpr double kMinReachable = 1.0 / 3;

}  // namespace

absl::Status SegmentMatcher::ProposeBest(std::span<const Views::value_type> views,
                                         const DepthBuffer::Sides& hidden, SearchBudget& budget) {
  const auto large_enough = LargeEnough(views, &budget);
  if (!large_enough.ok()) return large_enough.status();
  const Views distinct = DistinctTurns(*large_enough);
  std::vector<Start> all;
  TopScores top(budget.refined(), kTriedShare);
  double best_unrefined = 0;
  const auto min_score = [&] { return std::max(top.min(), kMinGlance); };
  for (std::span<const Views::value_type> left(distinct); !left.empty();) {
    const auto block = left.first(std::min({left.size(), kScreenedAtOnce, budget.left()}));
    if (budget.OutOfTime() || !budget.Take(block.size()) || block.empty()) {
      budget.Take(left.size());
      break;
    }
    left = left.subspan(block.size());
    auto starts = StartsOf(block, hidden);
    if (!starts.ok()) return starts.status();
    DropUnlikely(&*starts, &best_unrefined);
    ForEachIndex(starts->size(), [&, min = min_score()](std::size_t i) {
      (*starts)[i].score = Glance((*starts)[i], min);
    });
    for (Start& start : *starts) {
      top.Add(start.score);
      all.push_back(std::move(start));
    }
  }
  std::ranges::stable_sort(all, std::greater(), &Start::score);
  if (all.size() > budget.refined()) all.resize(budget.refined());
  std::erase_if(all, [&](const Start& start) { return start.score < min_score(); });
  if (absl::Status status = TryAll(all); !status.ok()) return status;
  return KeepBestAndFinish();
}

absl::StatusOr<Views> SegmentMatcher::LargeEnough(std::span<const Views::value_type> views,
                                                  SearchBudget* budget) {
  std::unordered_map<const SurfaceModel*, bool> known;
  Views out;
  for (const auto& view : views) {
    if (budget != nullptr && budget->OutOfTime()) {
      out.push_back(view);  // will not be tried either
      continue;
    }
    const auto start = StartOf(view);
    if (!start.ok()) return start.status();
    if (start->model == nullptr) continue;
    const auto [at, is_new] = known.try_emplace(start->model.get(), false);
    if (is_new) at->second = Reachable(*view, *start->model) >= kMinReachable;
    if (at->second) out.push_back(view);
  }
  return out;
}

double SegmentMatcher::Reachable(const TaughtView& view, const SurfaceModel& model) const {
  const auto tolerance = static_cast<float>(parameters_.support_distance_m);
  // A camera sees no far side, and noise makes no more voxels than that has points: 357 answers
  // explained 0.38 times as many voxels as the model has points in the median, 0.93 at the most.
  const double spacing = static_cast<double>(kSurfaceSpacingM) / segmentation_.voxel_size_m;
  const double covered = spacing * spacing * static_cast<double>(model.fine.cloud.points.size()) /
                         static_cast<double>(segment_.cloud.points.size());
  const double within = std::min(covered, reachable_.Within(model.radius_m + tolerance));
  if (!seen_.on_table) return within;
  float top = 0;
  for (const Eigen::Vector3f& p : model.coarse.cloud.points) {
    top = std::max(top, (view.world_object.cast<float>() * p).z());
  }
  return std::min(within, reachable_.NotHigher(top + tolerance));
}

Views SegmentMatcher::DistinctTurns(std::span<const Views::value_type> views) const {
  Views out;
  TriedTurns turns;
  for (const auto& view : views) {
    if (turns.Add(*view, seen_)) out.push_back(view);
  }
  return out;
}

absl::StatusOr<std::vector<SegmentMatcher::Start>> SegmentMatcher::StartsOf(
    std::span<const Views::value_type> views, const DepthBuffer::Sides& hidden) {
  std::vector<Start> models;
  for (const auto& view : views) {
    const auto start = StartOf(view);
    if (!start.ok()) return start.status();
    if (start->model != nullptr) models.push_back(*start);
  }
  if (!look_ups_ && !models.empty()) look_ups_.emplace(*this);
  std::vector<std::vector<Pose>> poses(models.size());
  ForEachIndex(models.size(), [&](std::size_t i) {
    InitialPoses initial = RoughPoses(*models[i].view, *models[i].model, seen_, hidden);
    poses[i] = std::move(initial.poses);
    models[i].visible = std::make_shared<std::vector<std::uint8_t>>(std::move(initial.visible));
  });
  std::vector<Start> out;
  for (std::size_t i = 0; i < models.size(); ++i) {
    for (const Pose& rough : poses[i]) {
      out.push_back(models[i]);
      out.back().rough = rough;
    }
  }
  Observe(PoseStep::kProposed, out, &Start::rough);
  return out;
}

absl::StatusOr<SegmentMatcher::Start> SegmentMatcher::StartOf(const Views::value_type& view) {
  if (absl::Status status = CheckNotCancelled(); !status.ok()) return status;
  const auto pose = catalogue_.stable_poses->find(view->stable_pose);
  if (pose == catalogue_.stable_poses->end()) return Start();
  const auto model = ModelOf(*view, *pose->second);
  if (!model.ok()) return model.status();
  Start out;
  out.view = view;
  out.symmetry_order = pose->second->symmetry_order;
  out.model = *model;
  return out;
}

// Loads a model once, not for each of the views that it is fused from.
absl::StatusOr<SegmentMatcher::Model> SegmentMatcher::ModelOf(const TaughtView& view,
                                                              const TaughtStablePose& stable_pose) {
  Model& known = models_[view.shares_frame ? static_cast<const void*>(&stable_pose) : &view];
  if (known) return known;
  auto model = clouds_.LoadModel(view, stable_pose);
  if (model.ok()) known = *model;
  return model;
}

void SegmentMatcher::DropUnlikely(std::vector<Start>* starts, double* best) const {
  ForEachIndex(starts->size(), [&, min = kUnrefinedShare * *best](std::size_t i) {
    Start& start = (*starts)[i];
    start.score = Verify(*start.model, start.rough, rough_columns_, depth_buffer_,
                         {.tolerance_m = kUnrefinedToleranceM,
                          .coarse = true,
                          .min_score = min,
                          .visible = start.visible.get()})
                      .score;
  });
  for (const Start& start : *starts) *best = std::max(*best, start.score);
  std::erase_if(*starts, [&](const Start& start) { return start.score < kUnrefinedShare * *best; });
}

double SegmentMatcher::Glance(const Start& start, double min_score) const {
  // Of small objects other points are visible after two steps: with those of the initial pose 3 of
  // 81 objects, 40 % hidden, are lost.
  const Pose pose =
      Refine(*start.model, look_ups_->rough_target, start.rough, kGlanceSteps).world_object;
  return VerifyRoughly(*start.model, pose, min_score).score;
}

}  // namespace graspdb::recognition
