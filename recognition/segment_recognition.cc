#include "recognition/segment_recognition.h"

#include <algorithm>
#include <span>

#include "absl/status/status.h"
#include "recognition/descriptor.h"
#include "recognition/view_matching.h"

namespace graspdb::recognition {
namespace {

// Null where it is not known any more.
const TaughtStablePose* StablePoseOf(const CatalogueSnapshot& catalogue,
                                     const Detection& detection) {
  if (!detection.view) return nullptr;
  const auto found = catalogue.stable_poses->find(detection.view->stable_pose);
  return found == catalogue.stable_poses->end() ? nullptr : found->second.get();
}

// A stable pose's own threshold is one of confidence, which the paper's way does not give.
double MinScore(const TaughtStablePose* taught, const MatchingParameters& parameters) {
  const bool own = parameters.use_own_min_scores && parameters.verified_view_count > 1;
  return own && taught != nullptr ? taught->min_score.value_or(parameters.min_score)
                                  : parameters.min_score;
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

// The paper's way: the nearest view is the answer.
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

// What explains the scan as well as the best hypothesis, the first one.
void AddRivals(const std::vector<PoseHypothesis>& hypotheses, double table_noise_m,
               const MatchingParameters& parameters, Detection* detection) {
  const PoseHypothesis& best = hypotheses.front();
  for (const PoseHypothesis& h : hypotheses) {
    const bool is_rival = h.standing == Standing::kAsGood;
    detection->ambiguous = detection->ambiguous || is_rival;
    // A declared symmetry says more exactly what follows than what happened to be tried.
    const bool is_turn = h.standing == Standing::kSameSurface && best.symmetry_order == 1;
    if (!is_rival && !is_turn) continue;
    if (h.view->stable_pose == best.view->stable_pose) {
      detection->equivalent_poses.push_back(h.refined);
    } else if (is_rival) {
      const Doubt doubt =
          DoubtsOf(h.evidence, *h.model, table_noise_m, parameters.support_distance_m);
      detection->alternatives.push_back({h.view, h.refined, Confidence(doubt)});
    }
  }
}

// Models of what the nearest views show are aligned and judged.
absl::Status VerifyModels(const MatchingInput& input, const Descriptor& descriptor,
                          const std::vector<Match>& nearest, const CatalogueSnapshot& catalogue,
                          ViewClouds& clouds, const MatchingParameters& parameters,
                          const IsCancelled& is_cancelled, Detection* detection) {
  const auto hypotheses =
      MatchModels(input, descriptor, nearest, catalogue, clouds, parameters, is_cancelled);
  if (!hypotheses.ok()) return hypotheses.status();
  if (hypotheses->empty()) return absl::OkStatus();
  const PoseHypothesis& best = hypotheses->front();
  detection->view = best.view;
  detection->model = best.model;
  detection->evidence = best.evidence;
  detection->doubt = DoubtsOf(best.evidence, *best.model, input.segmentation.table_noise_m,
                              parameters.support_distance_m);
  detection->score = Confidence(detection->doubt);
  detection->rough_pose = best.rough;
  detection->refined_pose = best.refined;
  detection->registration = {.target_source = Pose::Identity(),
                             .converged = true,
                             .iterations = best.iterations,
                             .rms_error_m = best.evidence.rms_m,
                             .inlier_fraction = best.evidence.scan_explained};
  AddRivals(*hypotheses, input.segmentation.table_noise_m, parameters, detection);
  for (Candidate& candidate : detection->candidates) {
    for (const PoseHypothesis& h : *hypotheses) {
      if (h.view == candidate.view && !candidate.verification_score)
        candidate.verification_score = h.evidence.score;
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Detection> RecognizeSegment(const MatchingInput& input,
                                           const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                                           const RecognitionParameters& parameters,
                                           const IsCancelled& is_cancelled, StageLog* log) {
  const Segment& segment = input.segment;
  Detection out;
  out.point_count = segment.cloud.points.size();
  out.centroid = segment.centroid;
  absl::StatusOr<Descriptor> descriptor;
  log->Measure("descriptor", out.point_count, [&] {
    descriptor =
        Describe(segment.cloud, input.segmentation.world_sensor, parameters.descriptor.kind);
    return out.point_count;
  });
  if (!descriptor.ok()) return out;  // a shape that cannot be described is not known
  std::vector<Match> matches;
  const MatchingParameters& matching = parameters.matching;
  log->Measure("match", out.point_count, [&] {
    matches = catalogue.index.Nearest(
        *descriptor, std::max(matching.candidate_count, matching.verified_view_count));
    return out.point_count;
  });
  if (matches.empty()) return out;
  const auto listed = std::min(matches.size(), static_cast<std::size_t>(matching.candidate_count));
  for (const Match& match : std::span(matches).first(std::max<std::size_t>(1, listed))) {
    out.candidates.push_back({match.view, match.distance, std::nullopt});
  }
  absl::Status status;
  log->Measure("register", out.point_count, [&] {
    status = matching.verified_view_count > 1
                 ? VerifyModels(input, *descriptor, matches, catalogue, clouds, matching,
                                is_cancelled, &out)
                 : TrustDescriptor(input, matches.front(), clouds, matching, &out);
    return out.point_count;
  });
  if (!status.ok()) return status;
  const TaughtStablePose* taught = StablePoseOf(catalogue, out);
  if (out.score < MinScore(taught, matching)) {
    out.outcome = RecognitionOutcome::kUnknownObject;
    if (out.view && matching.verified_view_count > 1) out.rejected_by = HeaviestDoubt(out.doubt);
    out.view = nullptr;
  } else if (out.registration.inlier_fraction < matching.min_inlier_fraction) {
    out.outcome = RecognitionOutcome::kIcpRejected;
    out.view = nullptr;
  } else {
    AddDeclaredTurns(taught, &out);
    CarryGrasps(taught, parameters.workspace, &out);
    if (out.ambiguous && out.outcome == RecognitionOutcome::kOk) {
      out.outcome = RecognitionOutcome::kAmbiguous;
    }
  }
  return out;
}

}  // namespace graspdb::recognition
