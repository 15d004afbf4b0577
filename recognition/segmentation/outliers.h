// Outlier removal.
#pragma once

#include <optional>

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"

namespace graspdb::recognition {

// Statistical outlier removal (Rusu et al. 2008): positions of the points whose mean distance to
// their `neighbor_count` nearest neighbours is at most the mean of all such distances plus
// `deviation_factor` standard deviations. All points when there are not more than `neighbor_count`
// of them. Exact. With a `viewpoint` distances count as shares of the point's own from there: a
// surface twice as far from a camera has its points twice as far apart, which are no outliers.
//
// O(n * neighbor_count) where the density varies as that of a surface does. nullopt where it would
// take more than 7.5 * 10^8 distances, as for very many coincident or scattered points
// (deterministic), and when cancelled.
std::optional<Indices> RemoveStatisticalOutliers(const Points& points, int neighbor_count,
                                                 double deviation_factor,
                                                 const IsCancelled& is_cancelled = {},
                                                 const Eigen::Vector3f* viewpoint = nullptr);

}  // namespace graspdb::recognition
