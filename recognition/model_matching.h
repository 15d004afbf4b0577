// Which taught stable pose, where: hypotheses from taught views, refined and judged on fused
// models.
#pragma once

#include <span>
#include <vector>

#include "recognition/recognizer.h"
#include "recognition/verification.h"

namespace graspdb::recognition {

// An explanation of a segment.
struct PoseHypothesis {
  std::shared_ptr<const TaughtView> view;  // that gave rise to it
  Pose rough = Pose::Identity();           // T_world_object
  Pose refined = Pose::Identity();
  int iterations = 0;  // of the last refinement
  Evidence evidence;
};

// What is asked: one segment of a scan.
struct MatchingInput {
  const Scan& scan;
  const Segmentation& segmentation;
  const Segment& segment;
};

// The hypotheses that explain the segment best, the best first; different from each other.
//
// First the stable poses and azimuths of `nearest`, the views with the most similar descriptors.
// Where none of them explains the segment, or something hides a part of it so that its
// descriptor says little, all taught views. Stable poses without a model are left out. Errors as
// LoadModel; CANCELLED.
absl::StatusOr<std::vector<PoseHypothesis>> MatchModels(
    const MatchingInput& input, std::span<const Match> nearest, const CatalogueSnapshot& catalogue,
    ViewClouds& clouds, const MatchingParameters& parameters, const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
