// Overlap of a segment with the true points.
#pragma once

#include <algorithm>
#include <set>
#include <vector>

#include "recognition/segmentation/segmentation.h"

namespace graspdb::testing {

// Intersection over union of a segment's points and the true ones.
inline double Overlap(const recognition::Segment& segment, const std::set<std::int32_t>& truth) {
  std::size_t both = 0;
  for (const std::int32_t i : segment.indices) both += truth.count(i);
  const std::size_t either = segment.indices.size() + truth.size() - both;
  return static_cast<double>(both) / static_cast<double>(either);
}

inline double BestOverlap(const std::vector<recognition::Segment>& segments,
                          const std::set<std::int32_t>& truth) {
  double best = 0;
  for (const recognition::Segment& s : segments) best = std::max(best, Overlap(s, truth));
  return best;
}

}  // namespace graspdb::testing
