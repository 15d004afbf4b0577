#include "recognition/recognizer.h"

#include <algorithm>

#include "absl/status/status.h"
#include "recognition/scene_answers.h"
#include "recognition/segment_answers.h"

namespace graspdb::recognition {
namespace {

// Outcome of the whole frame: kOk if any detection is.
RecognitionOutcome Summarize(const std::vector<Detection>& detections) {
  for (const Detection& d : detections) {
    if (d.outcome == RecognitionOutcome::kOk) return RecognitionOutcome::kOk;
  }
  return detections.front().outcome;
}

}  // namespace

absl::StatusOr<Recognition> Recognize(const Scan& scan, const CatalogueSnapshot& catalogue,
                                      ViewClouds& clouds, const RecognitionParameters& parameters,
                                      const IsCancelled& cancelled_by_caller) {
  const IsCancelled is_cancelled = Latched(cancelled_by_caller);
  StageLog log;
  absl::StatusOr<Segmentation> segmentation =
      SegmentScan(scan, parameters.segmentation, parameters.descriptor, is_cancelled, &log);
  if (!segmentation.ok()) return segmentation.status();

  Recognition out;
  out.revision = catalogue.revision;
  out.world_sensor = segmentation->world_sensor;
  out.world_frame = segmentation->world_frame;
  SegmentAnswers recognition(scan, *segmentation, catalogue, clouds, parameters, is_cancelled);
  // The single-view baseline is the paper's method and nothing else; a segmented scan has no
  // surroundings.
  const bool in_image = (parameters.scene.verify || parameters.scene.search) && !scan.segmented &&
                        parameters.matching.verified_view_count > 1;
  SceneFrame frame;
  absl::StatusOr<std::vector<AnsweredSegment>> answers = recognition.Take([&] {
    if (in_image && parameters.scene.search) {
      frame.Make(scan, *segmentation, parameters.scene.frame, {}, is_cancelled);
    }
  });
  if (!answers.ok()) return answers.status();
  recognition.Report(&log, &out);
  if (in_image) {
    absl::Status explained = ExplainScene(scan, *segmentation, catalogue, clouds, parameters,
                                          is_cancelled, std::move(frame), &log, &*answers);
    if (!explained.ok()) return explained;
  }
  const Eigen::Vector3d sensor = out.world_sensor.translation();
  std::ranges::stable_sort(*answers, {}, [&](const AnsweredSegment& answer) {
    return (answer.detection.centroid - sensor).squaredNorm();
  });
  for (AnsweredSegment& answer : *answers) out.detections.push_back(std::move(answer.detection));
  out.stages = log.reports();
  switch (segmentation->outcome) {
    case SegmentationOutcome::kEmptyRegion:
      out.outcome = RecognitionOutcome::kEmptyRegion;
      break;
    case SegmentationOutcome::kNoCluster:
    case SegmentationOutcome::kFound:
      if (!out.detections.empty()) out.outcome = Summarize(out.detections);
      break;
  }
  return out;
}

}  // namespace graspdb::recognition
