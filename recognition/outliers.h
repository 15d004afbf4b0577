// Points that stand alone.
#pragma once

#include "recognition/types.h"

namespace graspdb::recognition {

// Statistical outlier removal (Rusu et al. 2008): positions of the points whose
// mean distance to their `neighbor_count` nearest neighbours is at most the mean
// of all such distances plus `deviation_factor` standard deviations. All points
// when there are not more than `neighbor_count` of them. Exact.
Indices RemoveStatisticalOutliers(const Points& points, int neighbor_count,
                                  double deviation_factor);

}  // namespace graspdb::recognition
