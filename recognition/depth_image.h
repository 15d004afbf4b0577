// From a depth image to points.
#pragma once

#include <cstdint>
#include <span>

#include "recognition/types.h"

namespace graspdb::recognition {

// Points in the sensor frame, row by row, NaN where the depth is 0. `depth` holds
// width x height counts of `unit_m` metres along the sensor's z axis.
Points Unproject(std::span<const std::uint16_t> depth, const CameraIntrinsics& camera,
                 double unit_m);

}  // namespace graspdb::recognition
