// Euclidean clusters.
#pragma once

#include <vector>

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"

namespace graspdb::recognition {

// Splits the points into sets between which every distance exceeds `tolerance_m`. Sets with fewer
// than `min_count` points are left out. Each set is sorted, and the sets are sorted by their first
// point. O(n log n) for voxels, of which a sphere of that radius contains a limited number. Where
// cancelled, the result is meaningless.
std::vector<Indices> FindClusters(const Points& points, double tolerance_m, std::size_t min_count,
                                  const IsCancelled& is_cancelled = {});

// Joins parts of one object between which the sensor could not see, such as the far wall of a mug
// over its near rim. A cluster whose lowest point lies more than `max_gap_m` above the table must
// rest on a part that the sensor did not see: it is joined with the nearest other cluster within
// `max_gap_m`, if there is one. `heights`: each point's height above the table, metres. Clusters
// that float in chains are joined until 10^9 distances were computed, and then stay apart.
std::vector<Indices> JoinUnsupported(const Points& points, const std::vector<double>& heights,
                                     std::vector<Indices> clusters, double max_gap_m,
                                     const IsCancelled& is_cancelled = {});

}  // namespace graspdb::recognition
