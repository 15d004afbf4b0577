#include "recognition/recognizer.h"

#include <algorithm>
#include <iterator>
#include <span>

#include "absl/status/status.h"
#include "recognition/descriptor.h"
#include "recognition/fragments.h"
#include "recognition/model_matching.h"
#include "recognition/touching.h"
#include "recognition/view_matching.h"

namespace graspdb::recognition {
namespace {

void CarryGrasps(const CatalogueSnapshot& catalogue, const std::optional<Box>& workspace,
                 Detection* detection) {
  const auto found = catalogue.stable_poses->find(detection->view->stable_pose);
  if (found == catalogue.stable_poses->end() || found->second->grasps.empty()) {
    detection->outcome = RecognitionOutcome::kNoGrasp;
    return;
  }
  detection->grasps = ProposeGrasps(*found->second, detection->refined_pose, workspace);
  detection->outcome =
      detection->grasps.empty() ? RecognitionOutcome::kOutOfWorkspace : RecognitionOutcome::kOk;
}

double MinScore(const CatalogueSnapshot& catalogue, const Detection& detection,
                const MatchingParameters& parameters) {
  if (!parameters.use_own_min_scores || !detection.view) return parameters.min_score;
  const auto found = catalogue.stable_poses->find(detection.view->stable_pose);
  if (found == catalogue.stable_poses->end()) return parameters.min_score;
  return found->second->min_score.value_or(parameters.min_score);
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
  // A declared symmetry says more exactly what follows than what happened to be tried.
  for (const double turn : DeclaredTurns(best.symmetry_order)) {
    if (turn == 0) continue;
    detection->equivalent_poses.push_back(best.refined);
    detection->equivalent_poses.back().rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  }
  for (const PoseHypothesis& h : hypotheses) {
    const bool is_rival = h.standing == Standing::kAsGood;
    detection->ambiguous = detection->ambiguous || is_rival;
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
absl::Status VerifyModels(const MatchingInput& input, const std::vector<Match>& nearest,
                          const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                          const MatchingParameters& parameters, const IsCancelled& is_cancelled,
                          Detection* detection) {
  const auto hypotheses = MatchModels(input, nearest, catalogue, clouds, parameters, is_cancelled);
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
                 ? VerifyModels(input, matches, catalogue, clouds, matching, is_cancelled, &out)
                 : TrustDescriptor(input, matches.front(), clouds, matching, &out);
    return out.point_count;
  });
  if (!status.ok()) return status;
  if (out.score < MinScore(catalogue, out, matching)) {
    out.outcome = RecognitionOutcome::kUnknownObject;
    if (out.view && matching.verified_view_count > 1) out.rejected_by = HeaviestDoubt(out.doubt);
    out.view = nullptr;
  } else if (out.registration.inlier_fraction < matching.min_inlier_fraction) {
    out.outcome = RecognitionOutcome::kIcpRejected;
    out.view = nullptr;
  } else {
    CarryGrasps(catalogue, parameters.workspace, &out);
    if (out.ambiguous && out.outcome == RecognitionOutcome::kOk) {
      out.outcome = RecognitionOutcome::kAmbiguous;
    }
  }
  return out;
}

// What the camera saw as one may be several things.
absl::StatusOr<std::vector<AnsweredSegment>> Part(std::vector<AnsweredSegment> answers,
                                                  const Scan& scan,
                                                  const Segmentation& segmentation,
                                                  const RecognitionParameters& parameters,
                                                  const RecognizeAlone& recognize) {
  const auto smallest = static_cast<std::size_t>(parameters.segmentation.min_cluster_point_count);
  std::vector<AnsweredSegment> out;
  out.reserve(answers.size());
  for (AnsweredSegment& answer : answers) {
    auto things = PartTouching({scan, segmentation, answer.segment}, std::move(answer.detection),
                               smallest, parameters.matching.support_distance_m, recognize);
    if (!things.ok()) return things.status();
    std::ranges::move(*things, std::back_inserter(out));
  }
  return out;
}

// The best that can be said of the frame as a whole.
RecognitionOutcome Summarize(const std::vector<Detection>& detections) {
  for (const Detection& d : detections) {
    if (d.outcome == RecognitionOutcome::kOk) return RecognitionOutcome::kOk;
  }
  return detections.front().outcome;
}

}  // namespace

absl::StatusOr<Recognition> Recognize(const Scan& scan, const CatalogueSnapshot& catalogue,
                                      ViewClouds& clouds, const RecognitionParameters& parameters,
                                      const IsCancelled& is_cancelled) {
  StageLog log;
  absl::StatusOr<Segmentation> segmentation =
      SegmentScan(scan, parameters.segmentation, parameters.descriptor, is_cancelled, &log);
  if (!segmentation.ok()) return segmentation.status();

  Recognition out;
  out.revision = catalogue.revision;
  out.world_sensor = segmentation->world_sensor;
  out.world_frame = segmentation->world_frame;
  const RecognizeAlone recognize = [&](const Segment& segment) {
    return RecognizeSegment({scan, *segmentation, segment}, catalogue, clouds, parameters,
                            is_cancelled, &log);
  };
  std::vector<AnsweredSegment> answers;
  answers.reserve(segmentation->segments.size());
  for (const Segment& segment : segmentation->segments) {
    absl::StatusOr<Detection> detection = recognize(segment);
    if (!detection.ok()) return detection.status();
    answers.push_back({segment, *std::move(detection)});
  }
  JoinFragments(parameters.matching.support_distance_m, &answers);
  if (parameters.matching.verified_view_count > 1) {
    auto things = Part(std::move(answers), scan, *segmentation, parameters, recognize);
    if (!things.ok()) return things.status();
    answers = *std::move(things);
  }
  for (AnsweredSegment& answer : answers) out.detections.push_back(std::move(answer.detection));
  out.stages = log.reports();
  switch (segmentation->outcome) {
    case SegmentationOutcome::kEmptyRegion:
      out.outcome = RecognitionOutcome::kEmptyRegion;
      break;
    case SegmentationOutcome::kNoCluster:
      out.outcome = RecognitionOutcome::kNoCluster;
      break;
    case SegmentationOutcome::kFound:
      out.outcome = Summarize(out.detections);
      break;
  }
  return out;
}

}  // namespace graspdb::recognition
