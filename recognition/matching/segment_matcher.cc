#include "recognition/matching/segment_matcher.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "recognition/base/idle_cores.h"
#include "recognition/matching/recentring.h"
#include "recognition/verification/confidence.h"

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

// Whether `b` is the model of `a` at `pose` (T_world_object): up to 4 mm and 4 degrees from there.
bool IsThere(const PoseHypothesis& a, const Pose& pose, const PoseHypothesis& b) {
  // Not by pointers: a model dropped from a cache is loaded again at another address.
  return HaveSameModel(*a.view, *b.view) && IsSamePlace(*a.model, pose, b.refined);
}

// Keeps the `count` hypotheses with the best evidence, the best first, without duplicates of a
// better one.
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

// Points of the segment for first looks. Doubled, one more answer on the real frames is wrong and
// as many are right (docs/experiment.md).
constexpr std::size_t kRoughPoints = 200;
// Hypotheses that are refined in full; chosen. Doubled, the answers of docs/experiment.md are the
// same ("same answers" below), and up to twice as many are refined.
constexpr std::size_t kFinalists = 8;
// With a hypothesis of this score (0 to 1, chosen) and of this confidence no other view is tried: a
// brick that explained 95 % of a padlock had ended its search at a confidence of 0.80 (ADR 23).
// Twice as far from 1, either has the same answers.
constexpr double kExplained = 0.94;
constexpr double kMinEndConfidence = 0.9;
// Share of the facing surface of an unoccluded object that nothing hides; the rest is the sensor's
// noise at edges. Chosen; twice as far from 1, same answers.
constexpr double kMinUnoccluded = 0.97;
// Where no first look scores higher, nothing is refined in full before further views are tried: of
// 2,130 such searches, simulated and real, these views ended 14. With 0.7 it is 22 of 2,650. Twice
// as far from 1, same answers.
constexpr double kWorthFinishing = 0.6;
// Hypotheses that score lower after all first looks are not refined in full: of 396 searches with
// an answer, on real frames and of objects that touch or have 40 % hidden, one had no better
// glance. Doubled, one of 48 touching objects is lost.
constexpr double kExplainsLittle = 0.4;
// Maximum number of further refinements of the best hypothesis, while its score grows; chosen.
// Doubled, same answers.
constexpr int kPolishRounds = 5;
// Scores (0 to 1) that differ by no more than this are equal; chosen. Doubled, the best hypothesis
// is refined again less often, with the same answers.
constexpr double kPolished = 2e-4;
// A first look whose score is lower than that of the best refined hypothesis by more than this does
// not become the best; chosen. Doubled, more of them are refined, with the same answers.
constexpr double kMaxScoreGapRough = 0.25;
// The same after a refinement with thinned edges. Chosen; doubled, same answers.
constexpr double kMaxScoreGapFirst = 0.1;
// Hypotheses that score lower after a first look are finished only where none scores higher: in 96
// scenes with 40 % hidden the final best had at least 0.76. With 0, twice as far from 1, same
// answers.
constexpr double kMinRoughScore = 0.5;
// A first look: place and turn on the table. Chosen; not measured alone. With twice the iterations
// it takes up to twice as long; with twice the deviations the table counts a quarter.
constexpr RefinementOptions kRoughSteps = {.iterations = 6,
                                           .first_reach_m = 0.02,
                                           .last_reach_m = 0.008,
                                           .coarse = true,
                                           .height_deviation_m = 1e-4,
                                           .tilt_deviation_rad = 1e-3};

void TakeRefined(const Refinement& refinement, PoseHypothesis* h) {
  h->refined = refinement.world_object;
  h->iterations += refinement.iterations;
  h->converged = refinement.converged;
}

}  // namespace

SegmentMatcher::SegmentMatcher(const ScanDepths& scan, const Segmentation& segmentation,
                               const Segment& segment, const CatalogueSnapshot& catalogue,
                               ViewClouds& clouds, const MatchingParameters& parameters,
                               const IsCancelled& is_cancelled)
    : noise_m_(NoiseAt(segmentation, segment)),
      segmentation_(segmentation),
      segment_(segment),
      catalogue_(catalogue),
      clouds_(clouds),
      parameters_(parameters),
      is_cancelled_(is_cancelled),
      depth_buffer_(scan, segmentation.world_sensor, segment),
      seen_{segmentation.world_sensor, segment.centroid,
            ExtentOf(segment.cloud.points, depth_buffer_.sensor_world()), segmentation.HasGravity(),
            segmentation.table_reach_m},
      columns_(segment.cloud, StrideFor(segment, kFullPoints)),
      rough_columns_(segment.cloud, StrideFor(segment, kRoughPoints)),
      reachable_(segment.cloud.points, rough_columns_.stride()) {}

SegmentMatcher::LookUps::LookUps(const SegmentMatcher& matcher)
    : grid(matcher.segment_.cloud.points, kSegmentCellM, kSegmentReachM, matcher.is_cancelled_),
      target{matcher.segment_.cloud, matcher.columns_,       grid,
             matcher.depth_buffer_,  matcher.seen_.on_table, matcher.segmentation_.table},
      rough_target{matcher.segment_.cloud, matcher.rough_columns_, grid,
                   matcher.depth_buffer_,  matcher.seen_.on_table, matcher.segmentation_.table} {}

absl::Status SegmentMatcher::Propose(std::span<const Views::value_type> views,
                                     const DepthBuffer::Sides& hidden) {
  const auto starts = StartsOf(views, hidden);
  if (!starts.ok()) return starts.status();
  if (absl::Status status = TryAll(*starts); !status.ok()) return status;
  return KeepBestAndFinish();
}

bool SegmentMatcher::IsExplained() const {
  return !hypotheses_.empty() && hypotheses_.front().evidence.score >= kExplained &&
         ConfidenceOfBest() >= kMinEndConfidence;
}

bool SegmentMatcher::IsExplainedWhole() const {
  return IsExplained() && hypotheses_.front().evidence.unoccluded >= kMinUnoccluded;
}

bool SegmentMatcher::ExplainsNothing() const {
  return hypotheses_.empty() || ConfidenceOfBest() < kExplainsNothing;
}

double SegmentMatcher::ConfidenceOfBest() const {
  const PoseHypothesis& best = hypotheses_.front();
  return Confidence(
      ConfidenceFeaturesOf(best.evidence, *best.model, noise_m_, parameters_.support_distance_m));
}

absl::StatusOr<std::vector<PoseHypothesis>> SegmentMatcher::TakeRanked() {
  if (absl::Status status = FinishBest(); !status.ok()) return status;
  while (!hypotheses_.empty() && !hypotheses_.front().recentred && !ExplainsNothing()) {
    RecentrePose(&hypotheses_.front());
    RankClosely(columns_, depth_buffer_, parameters_.support_distance_m, &hypotheses_);
  }
  Observe(PoseStep::kRefined, hypotheses_, &PoseHypothesis::refined);
  return std::move(hypotheses_);
}

absl::Status SegmentMatcher::TryAll(const std::vector<Start>& starts) {
  Observe(PoseStep::kKept, starts, &Start::rough);
  const std::size_t before = hypotheses_.size();
  hypotheses_.resize(before + starts.size());
  ForEachIndex(starts.size(), [&](std::size_t i) { hypotheses_[before + i] = Tried(starts[i]); });
  return CheckNotCancelled();
}

PoseHypothesis SegmentMatcher::Tried(const Start& start) const {
  PoseHypothesis h;
  h.model = start.model;
  h.symmetry_order = start.symmetry_order;
  h.view = start.view;
  h.rough = start.rough;
  TakeRefined(Refine(*start.model, look_ups_->rough_target, start.rough, kRoughSteps), &h);
  h.evidence = VerifyRoughly(*start.model, h.refined);
  return h;
}

absl::Status SegmentMatcher::KeepBestAndFinish() {
  KeepBest(kFinalists, &hypotheses_);
  if (hypotheses_.empty() || hypotheses_.front().evidence.score < kWorthFinishing) {
    return CheckNotCancelled();
  }
  return FinishBest();
}

absl::Status SegmentMatcher::FinishBest() {
  if (std::ranges::all_of(hypotheses_, &PoseHypothesis::finished) ||
      hypotheses_.front().evidence.score < kExplainsLittle) {
    return CheckNotCancelled();
  }
  if (absl::Status status = FinishAll(); !status.ok()) return status;
  KeepBest(kFinalists, &hypotheses_);
  Polish();
  return CheckNotCancelled();
}

absl::Status SegmentMatcher::CheckNotCancelled() const {
  return is_cancelled_() ? absl::CancelledError("cancelled while aligning models")
                         : absl::OkStatus();
}

Evidence SegmentMatcher::VerifyRoughly(const SurfaceModel& model, const Pose& world_object,
                                       double min_score) const {
  return Verify(
      model, world_object, rough_columns_, depth_buffer_,
      {.tolerance_m = parameters_.support_distance_m, .coarse = true, .min_score = min_score});
}

Evidence SegmentMatcher::VerifyClosely(const SurfaceModel& model, const Pose& world_object) const {
  return Verify(model, world_object, columns_, depth_buffer_,
                {.tolerance_m = parameters_.support_distance_m});
}

// Refines the hypotheses in full, the most promising first. Skips those that score too low to catch
// up with the finished ones, and those that converge to a finished one of the same model.
absl::Status SegmentMatcher::FinishAll() {
  std::vector<PoseHypothesis> finished;
  double best = 0;
  for (PoseHypothesis& h : hypotheses_) {
    if (absl::Status status = CheckNotCancelled(); !status.ok()) return status;
    if (!h.finished) {
      if (h.evidence.score < kMinRoughScore && !finished.empty()) continue;
      if (h.evidence.score < best - kMaxScoreGapRough || !Approach(finished, &h)) continue;
      if (h.evidence.score < best - kMaxScoreGapFirst) continue;
      Finish(kLastSteps, &h);
    }
    best = std::max(best, h.evidence.score);
    finished.push_back(std::move(h));
  }
  hypotheses_ = std::move(finished);
  return absl::OkStatus();
}

// Refines with the model's edges thinned; false where that leads to a finished one.
bool SegmentMatcher::Approach(const std::vector<PoseHypothesis>& finished,
                              PoseHypothesis* h) const {
  const IsKnown is_finished = [&](const Pose& pose) {
    return std::ranges::any_of(
        finished, [&](const PoseHypothesis& other) { return IsThere(*h, pose, other); });
  };
  const Refinement refinement =
      Refine(*h->model, look_ups_->target, h->refined, kFirstSteps, is_finished);
  if (refinement.stopped) return false;
  TakeRefined(refinement, h);
  h->evidence = VerifyRoughly(*h->model, h->refined);
  return true;
}

void SegmentMatcher::Finish(const RefinementOptions& options, PoseHypothesis* h) const {
  TakeRefined(Refine(*h->model, look_ups_->target, h->refined, options), h);
  h->evidence = VerifyClosely(*h->model, h->refined);
  h->finished = true;
}

// Refinements of long objects stop a little short along their axis: the best hypothesis is refined
// again while its score improves.
void SegmentMatcher::Polish() {
  for (int round = 0; round < kPolishRounds && !hypotheses_.empty(); ++round) {
    if (is_cancelled_() || hypotheses_.front().polished) return;
    PoseHypothesis again = hypotheses_.front();
    Finish({}, &again);
    const double gain = again.evidence.score - hypotheses_.front().evidence.score;
    // An equally good pose has converged further.
    if (gain >= -kPolished) hypotheses_.front() = std::move(again);
    hypotheses_.front().polished = gain <= kPolished;
  }
}

void SegmentMatcher::RecentrePose(PoseHypothesis* h) const {
  const Judge judge = [&](const Pose& pose) { return VerifyClosely(*h->model, pose); };
  const Recentred recentred =
      Recentre(*h->model, {h->refined, h->evidence},
               InformationMatrixOf(*h->model, look_ups_->target, h->refined), judge);
  h->refined = recentred.world_object;
  h->evidence = recentred.evidence;
  h->recentred = true;
}

}  // namespace graspdb::recognition
