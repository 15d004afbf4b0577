// Clusters that only a narrow gap or the table's noise connects.
#pragma once

#include <vector>

#include "recognition/matching/model_matching.h"

namespace graspdb::recognition {

// The parts of a segment between which its voxels leave narrow gaps, once those low over the table
// are left out: a depth camera smooths, and bumps of the table reach from one object to the next.
// Low voxels near a part go with it, others are left out. Empty where that changes nothing: one
// part and less than `min_count` voxels left out. At least `min_count` high voxels a part. Where
// cancelled, the result is meaningless. O(n log n) for n points of the segment.
std::vector<Segment> SplitAtGaps(const MatchingInput& input, double voxel_size_m,
                                 std::size_t min_count, const IsCancelled& is_cancelled = {});

}  // namespace graspdb::recognition
