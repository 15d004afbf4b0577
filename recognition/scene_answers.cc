#include "recognition/scene_answers.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "recognition/scene/explained_pixels.h"
#include "recognition/scene/scene_score.h"
#include "recognition/scene_proposals.h"
#include "recognition/segment_recognition.h"
#include "recognition/segmentation/region.h"

namespace graspdb::recognition {
namespace {

// A proposal may share so many of its pixels with answers.
constexpr double kMaxExplainedShare = 0.3;
// A segment is a new detection's where so many of its points lie on it, and touches it where fewer
// do.
constexpr double kOwnShare = 0.6;
constexpr double kTouchingShare = 0.05;
// No confidence in an answer is nearer to 0 or 1.
constexpr double kMinConfidence = 0.015;
double ScoreOf(double log_odds) { return 1 / (1 + std::exp(-log_odds)); }

void Reject(double score, Detection* detection) {
  detection->score = std::min(detection->score, score);
  detection->outcome = RecognitionOutcome::kUnknownObject;
  detection->rejected_by = Gate::kModel;
  detection->view = nullptr;
  detection->grasps.clear();
  detection->equivalent_poses.clear();
  detection->alternatives.clear();
  detection->ambiguous = false;
}

class Scene {
 public:
  Scene(const SceneInput& input, Frame frame)
      : input_(input), world_sensor_(input.segmentation.world_sensor), frame_(std::move(frame)) {}

  const Frame& frame() const { return frame_; }
  // Whether the scan is no image that a camera could have taken.
  bool is_empty() const { return frame_.depth.empty(); }
  absl::Status Verify(std::vector<AnsweredSegment>* answers);
  absl::Status Explain(std::vector<SceneProposal> proposals, std::vector<AnsweredSegment>* answers);

 private:
  void VerifyOne(Detection* detection);
  absl::Status CheckNotCancelled() const {
    return input_.is_cancelled() ? absl::CancelledError("cancelled while explaining the scene")
                                 : absl::OkStatus();
  }
  double ShareOn(const std::vector<bool>& pixels, const Segment& segment) const;
  void TakeSegments(const std::vector<bool>& pixels, Detection* found,
                    std::vector<AnsweredSegment>* answers) const;

  const SceneInput& input_;
  const Pose world_sensor_;
  Frame frame_;
};

absl::Status Scene::Verify(std::vector<AnsweredSegment>* answers) {
  for (AnsweredSegment& answer : *answers) {
    if (answer.detection.view == nullptr) continue;
    if (absl::Status status = CheckNotCancelled(); !status.ok()) return status;
    VerifyOne(&answer.detection);
  }
  return absl::OkStatus();
}

void Scene::VerifyOne(Detection* detection) {
  if (detection->model == nullptr) return;
  const SceneParameters& scene = input_.parameters.scene;
  const ImageModel model = MakeImageModel(detection->model->fine.cloud, {});
  const Eigen::Isometry3f sensor_object =
      (world_sensor_.inverse() * detection->refined_pose).cast<float>();
  const SceneHypothesis judged = JudgePose(frame_, model, sensor_object, scene.object_search);
  const double own = std::clamp(detection->score, kMinConfidence, 1 - kMinConfidence);
  const ImageEvidenceParameters& evidence = scene.object_search.evidence;
  const double unlikely = std::min(0.0F, SceneScore(frame_, judged, evidence));
  const double score =
      ScoreOf(SceneScore(frame_, judged, evidence, kContradictions) +
              scene.unlikely_weight * unlikely + std::log(own / (1 - own)) - scene.segment_bar);
  const double min_score =
      MinScore(StablePoseOf(input_.catalogue, *detection), input_.parameters.matching);
  if (score < std::min(0.5, min_score)) {
    Reject(score, detection);
  } else {
    recognition::Explain(PixelsOn(frame_, model, sensor_object), &frame_);
  }
}

// Each accepted proposal explains pixels that are then no other's.
absl::Status Scene::Explain(std::vector<SceneProposal> proposals,
                            std::vector<AnsweredSegment>* answers) {
  for (SceneProposal& proposal : proposals) {
    if (absl::Status status = CheckNotCancelled(); !status.ok()) return status;
    const std::vector<bool> pixels = PixelsOn(frame_, *proposal.model, proposal.sensor_model);
    if (ExplainedShare(frame_, pixels) > kMaxExplainedShare) continue;
    AnsweredSegment answer;
    answer.detection = std::move(proposal.detection);
    CompleteDetection(StablePoseOf(input_.catalogue, answer.detection), input_.parameters.workspace,
                      &answer.detection);
    TakeSegments(pixels, &answer.detection, answers);
    recognition::Explain(pixels, &frame_);
    answers->push_back(std::move(answer));
  }
  return absl::OkStatus();
}

double Scene::ShareOn(const std::vector<bool>& pixels, const Segment& segment) const {
  if (segment.cloud.points.empty()) return 0;
  const Eigen::Isometry3f sensor_world = world_sensor_.inverse().cast<float>();
  const auto is_on = [&](const Eigen::Vector3f& p) {
    const std::ptrdiff_t pixel = frame_.PixelOf(sensor_world * p);
    return pixel >= 0 && pixels[static_cast<std::size_t>(pixel)];
  };
  return static_cast<double>(std::ranges::count_if(segment.cloud.points, is_on)) /
         static_cast<double>(segment.cloud.points.size());
}

// Unknown segments that lie on a new detection are removed. One that lies there in part touches it.
void Scene::TakeSegments(const std::vector<bool>& pixels, Detection* found,
                         std::vector<AnsweredSegment>* answers) const {
  std::erase_if(*answers, [&](AnsweredSegment& answer) {
    if (answer.detection.view != nullptr) return false;
    const double share = ShareOn(pixels, answer.segment);
    if (share < kOwnShare) {
      const bool touches = share >= kTouchingShare;
      answer.detection.touching = answer.detection.touching || touches;
      found->touching = found->touching || touches;
      return false;
    }
    if (found->candidates.empty()) found->candidates = std::move(answer.detection.candidates);
    return true;
  });
}

std::size_t AcceptedCount(const std::vector<AnsweredSegment>& answers) {
  return static_cast<std::size_t>(std::ranges::count_if(
      answers, [](const AnsweredSegment& a) { return a.detection.view != nullptr; }));
}

// Sensor frame.
Points AcceptedPoints(const std::vector<AnsweredSegment>& answers, const Pose& world_sensor) {
  const Eigen::Isometry3f sensor_world = world_sensor.inverse().cast<float>();
  Points out;
  for (const AnsweredSegment& answer : answers) {
    if (answer.detection.view == nullptr) continue;
    for (const auto& p : answer.segment.cloud.points) out.push_back(sensor_world * p);
  }
  return out;
}

std::size_t ObjectPixels(const Frame& frame) {
  return static_cast<std::size_t>(std::ranges::count(frame.role, PixelRole::kObject));
}

}  // namespace

void SceneFrame::Make(const Scan& scan, const Segmentation& segmentation,
                      const FrameParameters& parameters, const Points& of_interest,
                      const IsCancelled& is_cancelled) {
  log.Measure("frame", scan.size(), [&] {
    frame = MakeFrame(scan, segmentation.world_sensor, segmentation.table,
                      scan.region.value_or(DefaultRegion(segmentation.world_sensor)), parameters,
                      is_cancelled, of_interest);
    return ObjectPixels(*frame);
  });
}

absl::Status ExplainScene(const Scan& scan, const Segmentation& segmentation,
                          const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                          const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
                          SceneFrame frame, StageLog* log, std::vector<AnsweredSegment>* answers) {
  if (catalogue.stable_poses == nullptr) return absl::OkStatus();
  const bool search = parameters.scene.search;
  if (!search && AcceptedCount(*answers) == 0) return absl::OkStatus();
  const SceneInput input{scan, segmentation, catalogue, clouds, parameters, is_cancelled};
  if (!frame.frame) {
    frame.Make(scan, segmentation, parameters.scene.frame,
               AcceptedPoints(*answers, segmentation.world_sensor), is_cancelled);
  }
  log->Add(frame.log);
  if (is_cancelled()) return absl::CancelledError("cancelled while making the frame");
  Scene scene(input, *std::move(frame.frame));
  if (scene.is_empty()) return absl::OkStatus();
  absl::Status status;
  if (parameters.scene.verify) {
    log->Measure("verify", AcceptedCount(*answers), [&] {
      status = scene.Verify(answers);
      return AcceptedCount(*answers);
    });
  }
  if (!status.ok() || !search) return status;
  absl::StatusOr<std::vector<SceneProposal>> proposals;
  log->Measure("propose", ObjectPixels(scene.frame()), [&] {
    proposals = ProposeObjects(input, scene.frame(), *answers);
    return proposals.ok() ? proposals->size() : 0;
  });
  if (!proposals.ok()) return proposals.status();
  if (proposals->empty()) return absl::OkStatus();
  log->Measure("confirm", proposals->size(), [&] {
    status = ConfirmProposals(input, scene.frame(), &*proposals);
    return proposals->size();
  });
  if (!status.ok()) return status;
  log->Measure("explain", proposals->size(), [&] {
    status = scene.Explain(*std::move(proposals), answers);
    return AcceptedCount(*answers);
  });
  return status;
}

}  // namespace graspdb::recognition
