// How large one object can be.
#pragma once

#include <cstddef>

#include "recognition/base/types.h"
#include "recognition/segmentation/region.h"

namespace graspdb::recognition {

// Leaves out the points that are more than `max_size_m` from the median along an axis: no object of
// that size reaches there from where most of its points are. Returns how many. O(n).
std::size_t LeaveOutFarPoints(double max_size_m, RegionPoints* cloud);

// Whether the points cannot be one object of `max_size_m`: their bounding box has a longer side.
// O(n).
bool IsTooLarge(const Points& points, double max_size_m);

}  // namespace graspdb::recognition
