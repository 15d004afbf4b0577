#include "recognition/segment_recognition.h"

#include <algorithm>
#include <span>

#include "absl/status/status.h"
#include "recognition/descriptors/descriptor.h"
#include "recognition/matching/matching_parameters.h"
#include "recognition/matching/registration.h"
#include "recognition/models/taught.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {
namespace {

// How a view was aligned with a segment.
struct ViewAlignment {
  Pose rough = Pose::Identity();    // T_world_object after the shift
  Pose refined = Pose::Identity();  // T_world_object after the alignment
  Registration registration;
  double score = 0;  // how well view and segment explain each other, 0 to 1
};

// Moves the view's cloud to the segment's centroid (the rough pose), refines it by ICP and judges
// it. Errors as `clouds`.
absl::StatusOr<ViewAlignment> AlignView(const TaughtView& view, const Segment& segment,
                                        ViewClouds& clouds, const MatchingParameters& parameters) {
  const auto cloud = clouds.Load(view);
  if (!cloud.ok()) return cloud.status();
  const Points& points = (*cloud)->points;
  const PointSearch search(segment.cloud.points);
  ViewAlignment out;
  Pose shift = Pose::Identity();
  shift.translation() = segment.centroid - Centroid(points);
  out.rough = shift * view.world_object;
  out.registration = Align(points, {segment.cloud, search}, shift, parameters);
  out.refined = out.registration.target_source * view.world_object;

  const Points moved = Transform(out.registration.target_source, points);
  const double view_by_scan = Support(moved, search, parameters.support_distance_m);
  const double scan_by_view =
      Support(segment.cloud.points, PointSearch(moved), parameters.support_distance_m);
  const double sum = view_by_scan + scan_by_view;
  out.score = sum > 0 ? 2 * view_by_scan * scan_by_view / sum : 0;
  return out;
}

void AddDeclaredTurns(const TaughtStablePose* taught, Detection* detection) {
  if (taught == nullptr) return;
  std::vector<Pose> turned;
  for (const double turn : DeclaredTurns(taught->symmetry_order)) {
    if (turn == 0) continue;
    turned.push_back(detection->refined_pose);
    turned.back().rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  }
  detection->equivalent_poses.insert(detection->equivalent_poses.begin(), turned.begin(),
                                     turned.end());
}

void CarryGrasps(const TaughtStablePose* taught, const std::optional<Box>& workspace,
                 Detection* detection) {
  if (taught == nullptr || taught->grasps.empty()) {
    detection->outcome = RecognitionOutcome::kNoGrasp;
    return;
  }
  detection->grasps = ProposeGrasps(*taught, detection->refined_pose, workspace);
  detection->outcome =
      detection->grasps.empty() ? RecognitionOutcome::kOutOfWorkspace : RecognitionOutcome::kOk;
}

// Single-view baseline: the nearest view is the answer.
absl::Status TrustDescriptor(const MatchingInput& input, const Match& nearest, ViewClouds& clouds,
                             const MatchingParameters& parameters, Detection* detection) {
  auto alignment = AlignView(*nearest.view, input.segment, clouds, parameters);
  if (!alignment.ok()) return alignment.status();
  detection->view = nearest.view;
  detection->score = alignment->score;
  detection->rough_pose = alignment->rough;
  detection->refined_pose = alignment->refined;
  detection->registration = alignment->registration;
  detection->candidates.front().verification_score = alignment->score;
  return absl::OkStatus();
}

// Adds the hypotheses that explain the scan as well as the best one, the first.
void AddRivals(const std::vector<PoseHypothesis>& hypotheses, double noise_m,
               const MatchingParameters& parameters, Detection* detection) {
  const PoseHypothesis& best = hypotheses.front();
  for (const PoseHypothesis& h : hypotheses) {
    const bool is_rival = h.rank_class == RankClass::kAsGood;
    detection->ambiguous = detection->ambiguous || is_rival;
    // The turns of a declared symmetry are more exact than those that happened to be tried.
    const bool is_turn = h.rank_class == RankClass::kSameSurface && best.symmetry_order == 1;
    if (!is_rival && !is_turn) continue;
    if (h.view->stable_pose == best.view->stable_pose) {
      detection->equivalent_poses.push_back(h.refined);
    } else if (is_rival) {
      const ConfidenceFeatures features =
          ConfidenceFeaturesOf(h.evidence, *h.model, noise_m, parameters.support_distance_m);
      detection->alternatives.push_back({h.view, h.refined, Confidence(features)});
    }
  }
}

// Whether only a minimum score that somebody chose rejects such a confidence.
bool IsUsuallyEnough(double confidence) { return confidence >= MatchingParameters().min_score; }

}  // namespace

const TaughtStablePose* StablePoseOf(const CatalogueSnapshot& catalogue,
                                     const Detection& detection) {
  if (!detection.view) return nullptr;
  const auto found = catalogue.stable_poses->find(detection.view->stable_pose);
  return found == catalogue.stable_poses->end() ? nullptr : found->second.get();
}

// A stable pose's own threshold applies to the confidence, which the single-view baseline does not
// compute.
double MinScore(const TaughtStablePose* taught, const MatchingParameters& parameters) {
  const bool own = parameters.use_own_min_scores && parameters.verified_view_count > 1;
  return own && taught != nullptr ? taught->min_score.value_or(parameters.min_score)
                                  : parameters.min_score;
}

void CompleteDetection(const TaughtStablePose* taught, const std::optional<Box>& workspace,
                       Detection* detection) {
  AddDeclaredTurns(taught, detection);
  CarryGrasps(taught, workspace, detection);
  if (detection->ambiguous && detection->outcome == RecognitionOutcome::kOk) {
    detection->outcome = RecognitionOutcome::kAmbiguous;
  }
}

SegmentRecognition::SegmentRecognition(const MatchingInput& input, const ScanDepths& depths,
                                       const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                                       const RecognitionParameters& parameters,
                                       const IsCancelled& is_cancelled, StageLog* log)
    : input_(input),
      depths_(depths),
      catalogue_(catalogue),
      clouds_(clouds),
      parameters_(parameters),
      is_cancelled_(is_cancelled),
      log_(log) {
  out_.point_count = input.segment.cloud.points.size();
  out_.centroid = input.segment.centroid;
  if (input.segment.too_large) out_.rejected_by = Gate::kExtent;
}

absl::StatusOr<bool> SegmentRecognition::TryNearest() {
  absl::StatusOr<bool> explained = false;
  const MatchingParameters& matching = parameters_.matching;
  if (search_ || out_.rejected_by ||
      !FindNearest(std::max(matching.candidate_count, matching.verified_view_count))) {
    return explained;
  }
  if (is_cancelled_()) return absl::CancelledError("cancelled after the descriptor");
  if (matching.verified_view_count == 1) return explained;
  if (!MayBeAccepted()) {
    const double noise = NoiseAt(input_.segmentation, input_.segment);
    out_.rejected_by = IsUsuallyEnough(MaxConfidence(out_.point_count, noise)) ? Gate::kMinScore
                                                                               : Gate::kLittleSeen;
    return explained;
  }
  log_->Measure("register", out_.point_count, [&] {
    explained = BeginSearch().TryNearest();
    return out_.point_count;
  });
  explained_ = explained.ok() && *explained;
  return explained;
}

ModelSearch& SegmentRecognition::BeginSearch() {
  return search_.emplace(input_, depths_, *descriptor_, matches_, catalogue_, clouds_,
                         parameters_.matching, is_cancelled_);
}

// Whether some stable pose is accepted with the confidence that a segment of this size can reach.
bool SegmentRecognition::MayBeAccepted() const {
  const double noise = NoiseAt(input_.segmentation, input_.segment);
  const double max_confidence = MaxConfidence(out_.point_count, noise);
  if (max_confidence >= parameters_.matching.min_score) return true;
  return std::ranges::any_of(*catalogue_.stable_poses, [&](const auto& named) {
    return max_confidence >= MinScore(named.second.get(), parameters_.matching);
  });
}

// False for a shape that cannot be described; it is unknown.
bool SegmentRecognition::FindNearest(int count) {
  log_->Measure("descriptor", out_.point_count, [&] {
    auto descriptor = Describe(input_.segment.cloud, input_.segmentation.world_sensor,
                               parameters_.descriptor.kind);
    if (descriptor.ok()) descriptor_ = *std::move(descriptor);
    return out_.point_count;
  });
  if (!descriptor_) return false;
  log_->Measure("match", out_.point_count, [&] {
    matches_ = catalogue_.index.Nearest(*descriptor_, count);
    return out_.point_count;
  });
  const auto listed = std::min(
      matches_.size(), static_cast<std::size_t>(std::max(1, parameters_.matching.candidate_count)));
  for (const Match& match : std::span(matches_).first(listed)) {
    out_.candidates.push_back({match.view, match.distance, std::nullopt});
  }
  return !matches_.empty();
}

absl::StatusOr<Detection> SegmentRecognition::Answer(SearchBudget* further) {
  if (!search_ && out_.candidates.empty()) {
    if (auto tried = TryNearest(); !tried.ok()) return tried.status();
  }
  absl::Status status;
  log_->Measure("register", 0, [&] {
    if (search_) {
      if (!explained_ && further != nullptr) status = search_->TryFurther(*further);
      if (status.ok()) status = TakeBest();
    } else if (!matches_.empty() && !out_.rejected_by) {
      status = TrustDescriptor(input_, matches_.front(), clouds_, parameters_.matching, &out_);
    }
    return std::size_t{0};
  });
  if (!status.ok()) return status;
  Decide();
  return std::move(out_);
}

absl::Status SegmentRecognition::TakeBest() {
  const auto ranked = search_->TakeRanked();
  if (!ranked.ok()) return ranked.status();
  const std::vector<PoseHypothesis>& hypotheses = *ranked;
  if (hypotheses.empty()) return absl::OkStatus();
  const double noise = NoiseAt(input_.segmentation, input_.segment);
  const PoseHypothesis& best = hypotheses.front();
  out_.view = best.view;
  out_.model = best.model;
  out_.evidence = best.evidence;
  out_.features = ConfidenceFeaturesOf(best.evidence, *best.model, noise,
                                       parameters_.matching.support_distance_m);
  out_.score = Confidence(out_.features);
  out_.rough_pose = best.rough;
  out_.refined_pose = best.refined;
  out_.registration = {.target_source = Pose::Identity(),
                       .converged = best.converged,
                       .iterations = best.iterations,
                       .rms_error_m = best.evidence.rms_m,
                       .inlier_fraction = best.evidence.confirmed};
  AddRivals(hypotheses, noise, parameters_.matching, &out_);
  for (Candidate& candidate : out_.candidates) {
    for (const PoseHypothesis& h : hypotheses) {
      if (h.view == candidate.view && !candidate.verification_score)
        candidate.verification_score = h.evidence.score;
    }
  }
  return absl::OkStatus();
}

// Accepts or rejects the best hypothesis.
void SegmentRecognition::Decide() {
  if (out_.candidates.empty()) return;
  const MatchingParameters& matching = parameters_.matching;
  const TaughtStablePose* taught = StablePoseOf(catalogue_, out_);
  const double explained =
      out_.model != nullptr ? out_.evidence.scan_explained : out_.registration.inlier_fraction;
  if (out_.score < MinScore(taught, matching)) {
    out_.outcome = RecognitionOutcome::kUnknownObject;
    if (out_.view && matching.verified_view_count > 1) {
      out_.rejected_by =
          IsUsuallyEnough(out_.score) ? Gate::kMinScore : HeaviestFeature(out_.features);
    }
    out_.view = nullptr;
  } else if (explained < matching.min_inlier_fraction) {
    out_.outcome = RecognitionOutcome::kIcpRejected;
    out_.view = nullptr;
  } else {
    CompleteDetection(taught, parameters_.workspace, &out_);
  }
}

}  // namespace graspdb::recognition
