#include "recognition/recognizer.h"

#include <algorithm>
#include <iterator>

#include "absl/status/status.h"
#include "recognition/fragments.h"
#include "recognition/segment_recognition.h"
#include "recognition/touching.h"

namespace graspdb::recognition {
namespace {

// What the camera saw as one may be several things.
absl::StatusOr<std::vector<AnsweredSegment>> Part(std::vector<AnsweredSegment> answers,
                                                  const Scan& scan,
                                                  const Segmentation& segmentation,
                                                  const RecognitionParameters& parameters,
                                                  const RecognizeAlone& recognize) {
  const PartingOptions options{
      .min_count = static_cast<std::size_t>(parameters.segmentation.min_cluster_point_count),
      .support_distance_m = parameters.matching.support_distance_m,
      .voxel_size_m = parameters.descriptor.voxel_size_m};
  std::vector<AnsweredSegment> out;
  out.reserve(answers.size());
  for (AnsweredSegment& answer : answers) {
    auto things = PartTouching({scan, segmentation, answer.segment}, std::move(answer.detection),
                               options, recognize);
    if (!things.ok()) return things.status();
    std::ranges::move(*things, std::back_inserter(out));
  }
  return out;
}

// Those that the nearest views explain. What lies on one of them is a piece of it, about which
// nothing needs to be asked: many views would be, for a descriptor of a piece says little.
absl::Status AnswerEasyOnes(const RecognizeAlone& recognize, double support_distance_m,
                            std::vector<AnsweredSegment>* answers) {
  for (AnsweredSegment& answer : *answers) {
    absl::StatusOr<Detection> detection = recognize(answer.segment);
    if (!detection.ok()) return detection.status();
    answer.detection = *std::move(detection);
  }
  JoinFragments(support_distance_m, answers);
  return absl::OkStatus();
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
  const auto recognize_by = [&](bool nearest_only) -> RecognizeAlone {
    return [&, nearest_only](const Segment& segment) {
      return RecognizeSegment({scan, *segmentation, segment, nearest_only}, catalogue, clouds,
                              parameters, is_cancelled, &log);
    };
  };
  const RecognizeAlone recognize = recognize_by(/*nearest_only=*/false);
  // A scan of one thing alone is that, whatever it looks like.
  const bool may_be_several = parameters.matching.verified_view_count > 1 && !scan.segmented;
  std::vector<AnsweredSegment> answers;
  answers.reserve(segmentation->segments.size());
  for (const Segment& segment : segmentation->segments) answers.push_back({segment, {}});
  if (may_be_several && answers.size() > 1) {
    const absl::Status status = AnswerEasyOnes(recognize_by(/*nearest_only=*/true),
                                               parameters.matching.support_distance_m, &answers);
    if (!status.ok()) return status;
  }
  for (AnsweredSegment& answer : answers) {
    if (answer.detection.model != nullptr) continue;
    absl::StatusOr<Detection> detection = recognize(answer.segment);
    if (!detection.ok()) return detection.status();
    answer.detection = *std::move(detection);
  }
  if (may_be_several) {
    auto things = Part(std::move(answers), scan, *segmentation, parameters, recognize);
    if (!things.ok()) return things.status();
    answers = *std::move(things);
  }
  JoinFragments(parameters.matching.support_distance_m, &answers);
  const Eigen::Vector3d sensor = out.world_sensor.translation();
  std::ranges::stable_sort(answers, {}, [&](const AnsweredSegment& answer) {
    return (answer.segment.centroid - sensor).squaredNorm();
  });
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
