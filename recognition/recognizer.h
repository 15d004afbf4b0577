// The whole pipeline: scan, segments, descriptors, nearest views, rough pose, refined pose, grasps.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/stages.h"
#include "recognition/descriptors/descriptor.h"
#include "recognition/index/catalogue_snapshot.h"
#include "recognition/matching/detection.h"
#include "recognition/matching/matching_parameters.h"
#include "recognition/scene/scene_parameters.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {

struct RecognitionParameters {
  SegmentationParameters segmentation;
  DescriptorParameters descriptor;
  MatchingParameters matching;
  SceneParameters scene;
  std::optional<Box> workspace;  // world frame; where the tool may go
};

struct Recognition {
  RecognitionOutcome outcome = RecognitionOutcome::kNoCluster;
  std::int64_t revision = 0;
  Pose world_sensor = Pose::Identity();
  WorldFrame world_frame = WorldFrame::kGiven;
  std::vector<Detection> detections;  // the nearest to the sensor first
  std::vector<StageReport> stages;
  // Views not evaluated because further_view_budget was spent, and whether the search ended early
  // because search_ceiling_s had passed.
  std::size_t untried_view_count = 0;
  bool out_of_time = false;
};

// Recognises all objects in a scan, also on idle cores. The same scan against the same snapshot
// gives the same answer. Errors as SegmentScan, and those of `clouds`. Thread-safe; `is_cancelled`
// is called from one thread at a time, not always the same.
absl::StatusOr<Recognition> Recognize(const Scan& scan, const CatalogueSnapshot& catalogue,
                                      ViewClouds& clouds, const RecognitionParameters& parameters,
                                      const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
