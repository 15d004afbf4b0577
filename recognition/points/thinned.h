// Thinning that keeps the sides of thin sheets apart.
#pragma once

#include "recognition/base/types.h"

namespace graspdb::recognition {

// The mean point and normal of each cubic cell of edge `cell_m` (m), and of each side that the
// surface has there. In the order in which the cells first appear; frame and units of the cloud.
// Points must be finite and within a million cells of the origin. O(n).
OrientedCloud ThinnedToCells(const OrientedCloud& cloud, float cell_m);

// Thinned to at most `max_points`: cells of `step_m` metres, and as much larger as it takes, which
// `step_m` is then.
OrientedCloud ThinnedToAtMost(std::size_t max_points, const OrientedCloud& cloud, float* step_m);

}  // namespace graspdb::recognition
