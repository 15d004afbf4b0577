// Hypotheses about one segment: made from taught views, refined and judged on fused models.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/base/search_budget.h"
#include "recognition/index/catalogue_snapshot.h"
#include "recognition/matching/detection.h"
#include "recognition/matching/matching_parameters.h"
#include "recognition/matching/ranking.h"
#include "recognition/matching/reachable_share.h"
#include "recognition/matching/refinement.h"
#include "recognition/matching/rough_pose.h"
#include "recognition/points/nearest_grid.h"
#include "recognition/simd/soa_cloud.h"
#include "recognition/verification/depth_buffer.h"

namespace graspdb::recognition {

// Confidence up to which a hypothesis explains nothing.
inline constexpr double kExplainsNothing = 0.01;

// Cells of the look-ups over a segment, and how far they reach, m: no farther than the first
// correspondences of a refinement. Cells of half that size take eight times as long to make, with
// as many right answers (ADR 27); those of twice that size (not measured) an eighth, and near the
// points return one up to 21 mm farther away than the nearest, in place of 10. Twice the reach
// makes more cells, which no refinement uses.
inline constexpr float kSegmentCellM = 0.006F;
inline constexpr float kSegmentReachM = 0.021F;

// Points for refinements in full; larger segments, of parts of half a metre and more, are
// subsampled. Doubled, a finalist of such a part takes twice as long; the 40,000 points below which
// nothing is subsampled are more than any part of 0.3 m has.
inline constexpr std::size_t kFullPoints = 20'000;
// So that about `wanted` points are left.
inline std::size_t StrideFor(const Segment& segment, std::size_t wanted) {
  return std::max<std::size_t>(1, segment.cloud.points.size() / wanted);
}

// Refinement in full: with thinned edges until nearly converged, then with all. The reach shrinks
// from 20 to 9 and from 8 to 5 mm, over as many iterations as RefinementOptions has. Chosen; not
// measured alone. With twice the iterations either takes up to twice as long.
inline constexpr RefinementOptions kFirstSteps = {
    .iterations = 6, .last_reach_m = 0.009, .coarse = true};
inline constexpr RefinementOptions kLastSteps = {.iterations = 4, .first_reach_m = 0.008};

using Views = std::vector<std::shared_ptr<const TaughtView>>;

// Aligns models with one segment and keeps the best hypotheses. The look-ups are made once for a
// segment, however often views are proposed. Not thread-safe; all references must outlive it.
class SegmentMatcher {
 public:
  SegmentMatcher(const ScanDepths& scan, const Segmentation& segmentation, const Segment& segment,
                 const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                 const MatchingParameters& parameters, const IsCancelled& is_cancelled);

  // Makes hypotheses from these views, keeps the best of all so far, and refines them in full where
  // one is promising. `hidden`: sides on which the segment may continue. CANCELLED; errors of
  // LoadModel.
  absl::Status Propose(std::span<const Views::value_type> views, const DepthBuffer::Sides& hidden);

  // The views whose model is large enough to explain a share of the segment that is worth a
  // hypothesis, and those not checked before the budget's deadline. CANCELLED; errors of LoadModel.
  absl::StatusOr<Views> LargeEnough(std::span<const Views::value_type> views,
                                    SearchBudget* budget = nullptr);

  // As Propose, but only of views that are large enough and score best after a glance, which takes
  // a quarter of the time; of the first ones that the budget allows.
  absl::Status ProposeBest(std::span<const Views::value_type> views,
                           const DepthBuffer::Sides& hidden, SearchBudget& budget);

  // No other view needs to be tried.
  bool IsExplained() const;
  // And no part of the best model is hidden: then no larger one would explain it as well.
  bool IsExplainedWhole() const;
  bool ExplainsNothing() const;

  void Forget() { hypotheses_.clear(); }

  const DepthBuffer& depth_buffer() const { return depth_buffer_; }

  // Refined in full, the first one recentred. Not earlier: displaced hypotheses would explain
  // enough to end the search, without a good pose. CANCELLED.
  absl::StatusOr<std::vector<PoseHypothesis>> TakeRanked();

 private:
  using Model = std::shared_ptr<const SurfaceModel>;

  // Made for the first hypothesis.
  struct LookUps {
    explicit LookUps(const SegmentMatcher& matcher);

    const NearestGrid grid;
    const RefinementTarget target;
    const RefinementTarget rough_target;
  };

  double ConfidenceOfBest() const;  // there must be one
  // Calls the observer with the `pose` of all of them.
  template <typename Posed>
  void Observe(PoseStep step, const std::vector<Posed>& all, Pose Posed::*pose) const {
    if (!parameters_.observer) return;
    std::vector<ObservedPose> poses;
    poses.reserve(all.size());
    for (const Posed& one : all) poses.push_back({one.view->stable_pose, one.*pose});
    parameters_.observer(step, PoseSource::kSegment, poses);
  }

  // A view's model at an initial pose.
  struct Start {
    std::shared_ptr<const TaughtView> view;
    int symmetry_order = 1;
    Model model;
    Pose rough = Pose::Identity();
    // Of the model's coarse surface, from about there; for all poses of a view.
    std::shared_ptr<const std::vector<std::uint8_t>> visible;
    double score = 0;  // of a glance
  };

  // An upper bound of the share of the segment that the model of `view` explains.
  double Reachable(const TaughtView& view, const SurfaceModel& model) const;
  // Without those that show a model as an earlier one does.
  Views DistinctTurns(std::span<const Views::value_type> views) const;
  // Without a pose; without a model where the view is no longer taught or has none.
  absl::StatusOr<Start> StartOf(const Views::value_type& view);
  // Of all views, in their order, except those that are no longer taught.
  absl::StatusOr<std::vector<Start>> StartsOf(std::span<const Views::value_type> views,
                                              const DepthBuffer::Sides& hidden);
  absl::StatusOr<Model> ModelOf(const TaughtView& view, const TaughtStablePose& stable_pose);
  // Drops those whose initial pose explains much less than the best of `best` and these.
  void DropUnlikely(std::vector<Start>* starts, double* best) const;
  double Glance(const Start& start, double min_score) const;
  absl::Status TryAll(const std::vector<Start>& starts);
  PoseHypothesis Tried(const Start& start) const;
  absl::Status KeepBestAndFinish();
  absl::Status FinishBest();
  absl::Status FinishAll();
  absl::Status CheckNotCancelled() const;
  bool Approach(const std::vector<PoseHypothesis>& finished, PoseHypothesis* h) const;
  void Finish(const RefinementOptions& options, PoseHypothesis* h) const;
  void Polish();
  void RecentrePose(PoseHypothesis* h) const;
  Evidence VerifyRoughly(const SurfaceModel& model, const Pose& world_object,
                         double min_score = 0) const;
  Evidence VerifyClosely(const SurfaceModel& model, const Pose& world_object) const;

  const double noise_m_;
  const Segmentation& segmentation_;
  const Segment& segment_;
  const CatalogueSnapshot& catalogue_;
  ViewClouds& clouds_;
  const MatchingParameters& parameters_;
  const IsCancelled& is_cancelled_;
  const DepthBuffer depth_buffer_;
  const SeenSegment seen_;
  const SoaCloud columns_;
  const SoaCloud rough_columns_;    // some of them
  const ReachableShare reachable_;  // of the same
  std::optional<LookUps> look_ups_;
  std::unordered_map<const void*, Model> models_;  // by stable pose, or by view
  std::vector<PoseHypothesis> hypotheses_;
};

}  // namespace graspdb::recognition
