// Which taught stable pose, where: hypotheses from taught views, refined and judged on fused
// models.
#pragma once

#include <span>
#include <vector>

#include "recognition/ranking.h"
#include "recognition/recognizer.h"

namespace graspdb::recognition {

// What is asked: one segment of a scan.
struct MatchingInput {
  const Scan& scan;
  const Segmentation& segmentation;
  const Segment& segment;
  bool nearest_only = false;  // what the nearest views do not explain is left for later
};

// The hypotheses that explain the segment best, ranked (see RankClosely);
// different from each other.
//
// First the stable poses and azimuths of `nearest`, the views with the most similar descriptors.
// Where none of them explains the segment, or something hides a part of it so that its
// descriptor says little, further views, the most similar first, 600 at most. Where none of these
// explains anything and an answer is wanted all the same (min_score 0), the nearest view alone.
// With `nearest_only` nothing further is asked, and there is no hypothesis unless one explains it.
// Stable poses without a model are left out. `nearest` is not empty and holds what the index finds
// for `descriptor`, that of the segment. Errors as LoadModel; CANCELLED.
absl::StatusOr<std::vector<PoseHypothesis>> MatchModels(
    const MatchingInput& input, const Descriptor& descriptor, std::span<const Match> nearest,
    const CatalogueSnapshot& catalogue, ViewClouds& clouds, const MatchingParameters& parameters,
    const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
