// The points of a depth image.
#pragma once

#include "recognition/points/depth_image.h"

namespace graspdb::testing {

// One for each pixel, row by row, sensor frame, m; NaN where the depth is 0.
recognition::Points PointsOf(const recognition::DepthImage& image);

}  // namespace graspdb::testing
