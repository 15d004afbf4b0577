// Hypotheses about one segment: made from taught views, refined and judged on fused models.
#pragma once

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

// An explanation that is not surer than this is none.
inline constexpr double kExplainsNothing = 0.01;

// Cells of the look-ups over a segment, and how far they reach, m: no farther than the first
// correspondences of a refinement. Halved, they take eight times as long to make, and as many
// answers are right.
inline constexpr float kSegmentCellM = 0.006F;
inline constexpr float kSegmentReachM = 0.021F;

using Views = std::vector<std::shared_ptr<const TaughtView>>;

// Aligns models with one segment and keeps the best hypotheses. What it looks objects up in is made
// once for a segment, however often more views are proposed. Not thread-safe; all references must
// outlive it.
class SegmentMatcher {
 public:
  SegmentMatcher(const ScanDepths& scan, const Segmentation& segmentation, const Segment& segment,
                 const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                 const MatchingParameters& parameters, const IsCancelled& is_cancelled);

  // Hypotheses from these views, the best of them and of those before kept, and refined in full
  // where one is promising. `hidden`: sides on which the segment may go on. CANCELLED; errors of
  // LoadModel.
  absl::Status Propose(std::span<const Views::value_type> views, const DepthBuffer::Sides& hidden);

  // Those of the views whose model may explain enough of the segment to be worth a hypothesis, by
  // its size, and those whose turn comes when the budget's time is over. CANCELLED; errors of
  // LoadModel.
  absl::StatusOr<Views> LargeEnough(std::span<const Views::value_type> views,
                                    SearchBudget* budget = nullptr);

  // As Propose, of those views only that are large enough and look best after a glance, which takes
  // a quarter of the time; of as many as the budget allows, the first ones.
  absl::Status ProposeBest(std::span<const Views::value_type> views,
                           const DepthBuffer::Sides& hidden, SearchBudget& budget);

  // No other view needs to be tried.
  bool IsExplained() const;
  // And nothing of what explains it is hidden: then nothing larger would do so as well.
  bool IsExplainedWhole() const;
  bool ExplainsNothing() const;

  // From now on little is refined in full: the answer is only where another search begins.
  void SeekBeginning() { only_beginning_ = true; }

  void Forget() { hypotheses_.clear(); }

  const DepthBuffer& depth_buffer() const { return depth_buffer_; }

  // Refined in full. What ranks first has recentred. Not before: what is far from its place would
  // be explained well enough to end the search, and have no good pose. CANCELLED.
  absl::StatusOr<std::vector<PoseHypothesis>> TakeRanked();

 private:
  using Model = std::shared_ptr<const SurfaceModel>;

  // Made when the first hypothesis needs them.
  struct LookUps {
    explicit LookUps(const SegmentMatcher& matcher);

    const NearestGrid grid;
    const RefinementTarget target;
    const RefinementTarget rough_target;
  };

  double ConfidenceOfBest() const;  // of one that is there

  // A view's model where it may stand.
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
  // Without those that show a model as one before them does.
  Views DistinctTurns(std::span<const Views::value_type> views) const;
  // Without a pose; without a model where the view is not taught any more or has none.
  absl::StatusOr<Start> StartOf(const Views::value_type& view);
  // Of all views, in their order; none of one that is not taught any more.
  absl::StatusOr<std::vector<Start>> StartsOf(std::span<const Views::value_type> views,
                                              const DepthBuffer::Sides& hidden);
  absl::StatusOr<Model> ModelOf(const TaughtView& view, const TaughtStablePose& stable_pose);
  // Those whose initial pose already explains much less than the best one, `best` and these.
  void DropHopeless(std::vector<Start>* starts, double* best) const;
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
  Evidence VerifyRoughly(const SurfaceModel& model, const Pose& world_object) const;
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
  bool only_beginning_ = false;
  std::optional<LookUps> look_ups_;
  std::unordered_map<const void*, Model> models_;  // by stable pose, or by view
  std::vector<PoseHypothesis> hypotheses_;
};

}  // namespace graspdb::recognition
