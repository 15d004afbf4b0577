#include "recognition/scene_answers.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "recognition/scene/explained_pixels.h"
#include "recognition/scene/scene_score.h"
#include "recognition/scene_proposals.h"
#include "recognition/segment_recognition.h"

namespace graspdb::recognition {
namespace {

// A proposal may share so many of its pixels with answers.
constexpr double kMaxExplainedShare = 0.3;
// A segment is explained where so many of its points lie on detections.
constexpr double kExplainedShare = 0.6;
// A detection touches what else is in a segment where some of the segment's points lie on it, but
// not nearly all.
constexpr double kTouchingShare = 0.05;
constexpr double kNearlyAll = 0.9;

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
  double ShareWhere(const Segment& segment, const std::function<bool(std::size_t)>& holds) const;
  void Touch(const Pixels& pixels, Detection* found, std::vector<AnsweredSegment>* answers) const;

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
  const double score = AnswerScore(frame_, judged, detection->score, scene);
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
    const Pixels pixels = PixelsOn(frame_, *proposal.model, proposal.sensor_model);
    if (ExplainedShare(frame_, pixels) > kMaxExplainedShare) continue;
    AnsweredSegment answer;
    answer.detection = std::move(proposal.detection);
    CompleteDetection(StablePoseOf(input_.catalogue, answer.detection), input_.parameters.workspace,
                      &answer.detection);
    Touch(pixels, &answer.detection, answers);
    recognition::Explain(pixels, &frame_);
    answers->push_back(std::move(answer));
  }
  // What is explained now is no unknown object.
  std::erase_if(*answers, [&](const AnsweredSegment& answer) {
    return answer.detection.view == nullptr && ShareWhere(answer.segment, [&](std::size_t pixel) {
                                                 return frame_.role[pixel] == PixelRole::kExplained;
                                               }) >= kExplainedShare;
  });
  return absl::OkStatus();
}

// The share of the segment's points in pixels for which `holds` is true.
double Scene::ShareWhere(const Segment& segment,
                         const std::function<bool(std::size_t)>& holds) const {
  if (segment.cloud.points.empty()) return 0;
  const Eigen::Isometry3f sensor_world = world_sensor_.inverse().cast<float>();
  const auto is_on = [&](const Eigen::Vector3f& p) {
    const std::ptrdiff_t pixel = frame_.PixelOf(sensor_world * p);
    return pixel >= 0 && holds(static_cast<std::size_t>(pixel));
  };
  return static_cast<double>(std::ranges::count_if(segment.cloud.points, is_on)) /
         static_cast<double>(segment.cloud.points.size());
}

// A new detection gets the candidates of the segment that it lies on. It touches what else is in
// that segment.
void Scene::Touch(const Pixels& pixels, Detection* found,
                  std::vector<AnsweredSegment>* answers) const {
  for (AnsweredSegment& answer : *answers) {
    const double share = ShareWhere(answer.segment, [&](std::size_t pixel) {
      return std::ranges::binary_search(pixels, pixel);
    });
    if (share < kTouchingShare) continue;
    if (found->candidates.empty()) found->candidates = answer.detection.candidates;
    if (share >= kNearlyAll) continue;
    answer.detection.touching = true;
    found->touching = true;
  }
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
    frame = MakeFrame(scan, segmentation.world_sensor, segmentation.table, *segmentation.region,
                      parameters, is_cancelled, of_interest);
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
    status = ConfirmProposals(input, scene.frame(), *answers, &*proposals);
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
