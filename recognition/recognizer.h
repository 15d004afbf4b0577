// The whole path: scan, segments, descriptors, nearest views, rough pose, refined
// pose, grasps.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/stages.h"
#include "recognition/descriptors/descriptor_parameters.h"
#include "recognition/index/catalogue_snapshot.h"
#include "recognition/matching/detection.h"
#include "recognition/matching/matching_parameters.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {

struct RecognitionParameters {
  SegmentationParameters segmentation;
  DescriptorParameters descriptor;
  MatchingParameters matching;
  std::optional<Box> workspace;  // world frame; where the tool may go
};

struct Recognition {
  RecognitionOutcome outcome = RecognitionOutcome::kNoCluster;
  std::int64_t revision = 0;
  Pose world_sensor = Pose::Identity();
  WorldFrame world_frame = WorldFrame::kGiven;
  std::vector<Detection> detections;  // the nearest to the sensor first
  std::vector<StageReport> stages;
  // Views that were not looked at since further_view_budget was spent, and whether the search ended
  // early since search_ceiling_s had passed.
  std::size_t untried_view_count = 0;
  bool out_of_time = false;
};

// Recognises everything in a scan, on idle cores too. The same scan against the same snapshot gives
// the same answer. Errors as SegmentScan, and those of `clouds`. Thread-safe; `is_cancelled` is
// called from one thread at a time, not always the same.
absl::StatusOr<Recognition> Recognize(const Scan& scan, const CatalogueSnapshot& catalogue,
                                      ViewClouds& clouds, const RecognitionParameters& parameters,
                                      const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
