// Detections of objects that were found without a segment.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "recognition/matching/detection.h"
#include "recognition/models/taught.h"
#include "recognition/recognizer.h"
#include "recognition/scene/object_search.h"
#include "recognition/segmentation/segmentation.h"
#include "recognition/verification/scan_depths.h"

namespace graspdb::recognition {

// A proposal with the scan's points that lie on it.
struct OwnPoints {
  const Scan& scan;
  const ScanDepths& depths;
  const Segmentation& segmentation;
  const Segment& segment;
};

// The detection of an object at `hypothesis`, aligned with its own points. Its score is their
// confidence alone; it has no grasps yet. `stable_poses` are those of `model`, at least one; the
// one that stands most upright is detected, by its view from the most similar direction. Absent
// where the object cannot stand like that (SceneParameters::max_tilt_rad). Errors as LoadModel.
absl::StatusOr<std::optional<Detection>> DetectionOf(const SceneHypothesis& hypothesis,
                                                     const StablePoses& stable_poses,
                                                     const OwnPoints& own, ViewClouds& clouds,
                                                     const RecognitionParameters& parameters,
                                                     const IsCancelled& is_cancelled);

// The same detection aligned without the points beside the model, which are those of neighbours
// that touch it. Absent where too few points are left.
std::optional<Detection> WithoutNeighbours(const SceneHypothesis& hypothesis,
                                           const Detection& detection, const OwnPoints& own,
                                           const RecognitionParameters& parameters,
                                           const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
