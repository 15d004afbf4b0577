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
  // A scan of one thing alone is that, whatever it looks like.
  if (parameters.matching.verified_view_count > 1 && !scan.segmented) {
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
