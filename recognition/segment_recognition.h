// What one segment of a scan is: descriptor, nearest views, models, pose, grasps.
#pragma once

#include "absl/status/statusor.h"
#include "recognition/model_matching.h"
#include "recognition/recognizer.h"
#include "recognition/stages.h"

namespace graspdb::recognition {

// Recognises the segment as one thing. Errors of `clouds`; CANCELLED.
absl::StatusOr<Detection> RecognizeSegment(const MatchingInput& input,
                                           const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                                           const RecognitionParameters& parameters,
                                           const IsCancelled& is_cancelled, StageLog* log);

}  // namespace graspdb::recognition
