#include "recognition/model_matching.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_map>
#include <unordered_set>

#include "absl/status/status.h"
#include "recognition/distinct_hypotheses.h"
#include "recognition/ranking.h"
#include "recognition/refinement.h"
#include "recognition/rough_pose.h"
#include "recognition/settling.h"

namespace graspdb::recognition {
namespace {

using Views = std::vector<std::shared_ptr<const TaughtView>>;
using Model = std::shared_ptr<const SurfaceModel>;

// Points of the segment that first looks are taken with.
constexpr std::size_t kRoughPoints = 200;
// Hypotheses that are refined in full.
constexpr std::size_t kFinalists = 8;
// A hypothesis with this score needs no other to be asked for.
constexpr double kExplained = 0.94;
// So much of its surface is in sight of what stands free; the rest is the sensor's noise at edges.
constexpr double kWhole = 0.97;
// Where the nearest views do not explain a segment, so many are asked at most: as many as the
// experiment's parts have, so that a request does not take longer the more is taught.
constexpr int kMostViews = 600;
constexpr std::size_t kGrowth = 4;  // so many times more each time, until one explains it
// The best hypothesis is refined again at most so often, while its score grows by more than this.
constexpr int kPolishRounds = 5;
// A score that changes by no more than this has not changed.
constexpr double kPolished = 2e-4;
// An explanation that is not surer than this is none.
constexpr double kExplainsNothing = 0.01;
// A first look that is worse than the best of what was refined by more than this does not become
// the best.
constexpr double kCatchesUp = 0.25;
// The same of one that was refined with thinned edges.
constexpr double kCatchesUpClosely = 0.1;
// A first look: place and turn on the table.
constexpr RefinementOptions kRoughSteps = {.iterations = 6,
                                           .first_reach_m = 0.02,
                                           .last_reach_m = 0.008,
                                           .coarse = true,
                                           .height_deviation_m = 1e-4,
                                           .tilt_deviation_rad = 1e-3};
// What a hypothesis is refined with in full: edges thinned, until little is left to go.
constexpr RefinementOptions kFirstSteps = {.iterations = 6, .last_reach_m = 0.009, .coarse = true};
constexpr RefinementOptions kLastSteps = {.iterations = 4, .first_reach_m = 0.008};
// Look-ups over the segment: cells, and how far they reach, m.
constexpr float kCellM = 0.003F;
constexpr float kReachM = 0.021F;

// Aligns models with one segment.
class Matcher {
 public:
  Matcher(const MatchingInput& input, const CatalogueSnapshot& catalogue, ViewClouds& clouds,
          const MatchingParameters& parameters, const IsCancelled& is_cancelled)
      : input_(input),
        catalogue_(catalogue),
        clouds_(clouds),
        parameters_(parameters),
        is_cancelled_(is_cancelled),
        sight_(input.scan, input.segmentation.world_sensor, input.segment),
        grid_(input.segment.cloud.points, kCellM, kReachM),
        seen_{input.segmentation.world_sensor, input.segment.centroid,
              ExtentOf(input.segment.cloud.points, sight_.sensor_world()),
              input.segmentation.world_frame != WorldFrame::kSensor,
              input.segmentation.table_reach_m},
        columns_(input.segment.cloud),
        rough_columns_(input.segment.cloud,
                       std::max<std::size_t>(1, columns_.point_count() / kRoughPoints)),
        target_{input.segment.cloud,     columns_, grid_, sight_, seen_.on_table,
                input.segmentation.table},
        rough_target_{input.segment.cloud, rough_columns_,          grid_, sight_,
                      seen_.on_table,      input.segmentation.table} {}

  // Rough hypotheses from these views, refined, the best ones kept. `hidden`: sides on which the
  // segment may go on.
  absl::Status Propose(std::span<const Views::value_type> views, const Sight::Sides& hidden) {
    for (const auto& view : views) {
      if (is_cancelled_()) return absl::CancelledError("cancelled while models were aligned");
      const auto pose = catalogue_.stable_poses->find(view->stable_pose);
      if (pose == catalogue_.stable_poses->end()) continue;
      auto model = ModelOf(*view, *pose->second);
      if (!model.ok()) return model.status();
      if (*model != nullptr) Try(view, *pose->second, *model, hidden);
    }
    KeepBest(kFinalists, &hypotheses_);
    FinishAll();
    KeepBest(kFinalists, &hypotheses_);
    Polish();
    return absl::OkStatus();
  }

  bool IsExplained() const {
    return !hypotheses_.empty() && hypotheses_.front().evidence.score >= kExplained;
  }

  // And nothing of what explains it is hidden: then nothing larger would do so as well.
  bool IsExplainedWhole() const {
    return IsExplained() && hypotheses_.front().evidence.in_sight >= kWhole;
  }

  bool ExplainsNothing() const {
    return hypotheses_.empty() ||
           Confidence(DoubtsOf(hypotheses_.front().evidence, *hypotheses_.front().model,
                               input_.segmentation.table_noise_m, parameters_.support_distance_m)) <
               kExplainsNothing;
  }

  void Forget() { hypotheses_.clear(); }

  const Sight& sight() const { return sight_; }

  // What ranks first has settled. Not before: what is far from its place would be explained well
  // enough to end the search, and have no good pose.
  std::vector<PoseHypothesis> TakeRanked() {
    while (!hypotheses_.empty() && !hypotheses_.front().settled) {
      LetSettle(&hypotheses_.front());
      RankClosely(columns_, sight_, parameters_.support_distance_m, &hypotheses_);
    }
    return std::move(hypotheses_);
  }

 private:
  // Asks for a model once, and not for each of the views that it is fused from.
  absl::StatusOr<Model> ModelOf(const TaughtView& view, const TaughtStablePose& stable_pose) {
    Model& known = models_[view.shares_frame ? static_cast<const void*>(&stable_pose) : &view];
    if (known) return known;
    auto model = clouds_.LoadModel(view, stable_pose);
    if (model.ok()) known = *model;
    return model;
  }

  void Try(const std::shared_ptr<const TaughtView>& view, const TaughtStablePose& stable_pose,
           const Model& model, const Sight::Sides& hidden) {
    for (const Pose& rough : RoughPoses(*view, *model, seen_, hidden)) {
      PoseHypothesis h;
      h.model = model;
      h.symmetry_order = stable_pose.symmetry_order;
      h.view = view;
      h.rough = rough;
      h.refined = Refine(*model, rough_target_, rough, kRoughSteps).world_object;
      h.evidence = VerifyRoughly(*model, h.refined);
      hypotheses_.push_back(std::move(h));
    }
  }

  Evidence VerifyRoughly(const SurfaceModel& model, const Pose& world_object) const {
    return Verify(model, world_object, rough_columns_, sight_,
                  {.tolerance_m = parameters_.support_distance_m, .coarse = true});
  }

  Evidence VerifyClosely(const SurfaceModel& model, const Pose& world_object) const {
    return Verify(model, world_object, columns_, sight_,
                  {.tolerance_m = parameters_.support_distance_m});
  }

  // Refines the hypotheses in full, the most promising first: not those that are so much worse
  // than what is finished that they will not catch up, nor any that is on its way to a place where
  // one of the same model is already.
  void FinishAll() {
    std::vector<PoseHypothesis> finished;
    double best = 0;
    for (PoseHypothesis& h : hypotheses_) {
      if (h.evidence.score < best - kCatchesUp || !Approach(finished, &h)) continue;
      if (h.evidence.score < best - kCatchesUpClosely) continue;
      Finish(kLastSteps, &h);
      best = std::max(best, h.evidence.score);
      finished.push_back(std::move(h));
    }
    hypotheses_ = std::move(finished);
  }

  // Refines with the model's edges thinned; false where that leads to what is finished.
  bool Approach(const std::vector<PoseHypothesis>& finished, PoseHypothesis* h) const {
    const IsKnown is_finished = [&](const Pose& pose) {
      return std::ranges::any_of(
          finished, [&](const PoseHypothesis& other) { return IsThere(*h, pose, other); });
    };
    const Refinement refinement = Refine(*h->model, target_, h->refined, kFirstSteps, is_finished);
    if (refinement.stopped) return false;
    h->refined = refinement.world_object;
    h->evidence = VerifyRoughly(*h->model, h->refined);
    return true;
  }

  void Finish(const RefinementOptions& options, PoseHypothesis* h) const {
    const Refinement refinement = Refine(*h->model, target_, h->refined, options);
    h->refined = refinement.world_object;
    h->iterations = refinement.iterations;
    h->evidence = VerifyClosely(*h->model, h->refined);
  }

  // Long things slide along themselves, and end a little short of their place: the best hypothesis
  // is refined again from where it is, as long as that makes it better.
  void Polish() {
    for (int round = 0; round < kPolishRounds && !hypotheses_.empty(); ++round) {
      PoseHypothesis again = hypotheses_.front();
      Finish({}, &again);
      const double gain = again.evidence.score - hypotheses_.front().evidence.score;
      // What is as good has settled farther.
      if (gain >= -kPolished) hypotheses_.front() = std::move(again);
      if (gain <= kPolished) return;
    }
  }

  void LetSettle(PoseHypothesis* h) const {
    const Judge judge = [&](const Pose& pose) { return VerifyClosely(*h->model, pose); };
    const Settled settled = Settle(*h->model, {h->refined, h->evidence},
                                   HoldOf(*h->model, target_, h->refined, {}), judge);
    h->refined = settled.world_object;
    h->evidence = settled.evidence;
    h->settled = true;
  }

  const MatchingInput& input_;
  const CatalogueSnapshot& catalogue_;
  ViewClouds& clouds_;
  const MatchingParameters& parameters_;
  const IsCancelled& is_cancelled_;
  const Sight sight_;
  const NearestGrid grid_;
  const SeenSegment seen_;
  const OrientedColumns columns_;
  const OrientedColumns rough_columns_;  // some of them
  const RefinementTarget target_;
  const RefinementTarget rough_target_;
  std::unordered_map<const void*, Model> models_;  // by stable pose, or by view
  std::vector<PoseHypothesis> hypotheses_;
};

// The views that come after those of `nearest`, the most similar first.
Views FurtherViews(const CatalogueSnapshot& catalogue, const Descriptor& descriptor,
                   std::span<const Match> nearest) {
  std::unordered_set<const TaughtView*> known;
  for (const Match& match : nearest) known.insert(match.view.get());
  Views out;
  for (const Match& match : catalogue.index.Nearest(descriptor, kMostViews)) {
    if (!known.contains(match.view.get())) out.push_back(match.view);
  }
  return out;
}

}  // namespace

absl::StatusOr<std::vector<PoseHypothesis>> MatchModels(
    const MatchingInput& input, const Descriptor& descriptor, std::span<const Match> nearest,
    const CatalogueSnapshot& catalogue, ViewClouds& clouds, const MatchingParameters& parameters,
    const IsCancelled& is_cancelled) {
  Matcher matcher(input, catalogue, clouds, parameters, is_cancelled);
  const Sight::Sides hidden = matcher.sight().HiddenSides();
  const bool is_cut_off = hidden != Sight::Sides{};
  Views asked;
  for (const Match& match : nearest) asked.push_back(match.view);
  if (absl::Status status = matcher.Propose(asked, hidden); !status.ok()) return status;
  if (is_cut_off ? matcher.IsExplainedWhole() : matcher.IsExplained()) return matcher.TakeRanked();
  if (input.nearest_only) return std::vector<PoseHypothesis>();
  Views further = FurtherViews(catalogue, descriptor, nearest);
  if (is_cut_off) {
    // The descriptor of a part says little, and a part of one thing is explained by others too.
    if (absl::Status status = matcher.Propose(further, hidden); !status.ok()) return status;
    if (matcher.IsExplained()) return matcher.TakeRanked();
    std::ranges::move(further, std::back_inserter(asked));
    further.clear();
  }
  const Sight::Sides unseen = matcher.sight().UnseenSides();
  // What was asked already is asked again, first, only where it could stand elsewhere.
  if (unseen != hidden) further.insert(further.begin(), asked.begin(), asked.end());
  if (further.empty()) return matcher.TakeRanked();
  std::size_t portion = kGrowth * asked.size();
  for (std::span<const Views::value_type> left(further); !left.empty(); portion *= kGrowth) {
    const auto next = left.first(std::min(portion, left.size()));
    left = left.subspan(next.size());
    if (absl::Status status = matcher.Propose(next, unseen); !status.ok()) return status;
    if (matcher.IsExplained()) return matcher.TakeRanked();
  }
  if (parameters.min_score < kExplainsNothing && !is_cut_off && matcher.ExplainsNothing()) {
    // An answer is wanted all the same: what the segment looks like says more than which of the
    // failures is the smallest.
    matcher.Forget();
    absl::Status status = matcher.Propose({&nearest.front().view, 1}, hidden);
    if (!status.ok()) return status;
  }
  return matcher.TakeRanked();
}

}  // namespace graspdb::recognition
