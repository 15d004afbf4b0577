// Detections of objects that were found without a segment.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "recognition/matching/detection.h"
#include "recognition/models/taught.h"
#include "recognition/recognizer.h"
#include "recognition/scene/object_search.h"

namespace graspdb::recognition {

// The detection of an object at `hypothesis`, with its grasps. `stable_poses` are those of `model`,
// at least one; the one that stands most upright is detected, by its view from the most similar
// direction. Absent where the object cannot stand like that (SceneParameters::max_tilt_rad), or
// `score` is less than the minimum of that stable pose. Errors as LoadModel.
absl::StatusOr<std::optional<Detection>> DetectionOf(const SceneHypothesis& hypothesis,
                                                     double score, const PairModel& model,
                                                     const StablePoses& stable_poses,
                                                     const Pose& world_sensor, ViewClouds& clouds,
                                                     const RecognitionParameters& parameters);

}  // namespace graspdb::recognition
