// Segments that may be pieces of one object.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {

// Positions of two segments.
using SegmentPair = std::pair<std::size_t, std::size_t>;

// The pairs whose bounding boxes leave a gap of no more than `max_gap_m` and that together may be
// one object of `max_size_m`, the smallest gap first. O(k²) for k segments: the caller limits them.
std::vector<SegmentPair> NeighbouringPairs(std::span<const Segment* const> segments,
                                           double max_gap_m, double max_size_m);

// Both as one segment. O(n) for n points.
Segment UnionOf(const Segment& a, const Segment& b);

}  // namespace graspdb::recognition
