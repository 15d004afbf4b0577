// Splits a segment in two.
#pragma once

#include <vector>

#include "recognition/matching/model_matching.h"

namespace graspdb::recognition {

// Two parts of a segment, each nearer to its own middle over the table (k-means with two means,
// which begin at the ends). The segment is not empty; a part may be. Deterministic; O(n) for n
// points. Where cancelled, the result is meaningless.
std::vector<Segment> SplitInHalves(const MatchingInput& input,
                                   const IsCancelled& is_cancelled = {});

}  // namespace graspdb::recognition
