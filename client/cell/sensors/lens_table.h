// Undistorts images of a lens.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "recognition/base/types.h"

namespace graspdb::client {

// For every pixel of the pinhole image, row by row, the nearest pixel of the distorted image, or -1
// if that is outside. Both have `camera`'s size, focal lengths and principal point. Depths are
// copied unchanged: they are along the axis, and must not be interpolated.
//
// `distortion` is the model of Brown, "Decentering Distortion of Lenses", Photogrammetric
// Engineering 1966, in OpenCV's order: k1, k2, p1, p2, k3.
std::vector<std::int32_t> LensTable(const recognition::CameraIntrinsics& camera,
                                    const std::array<double, 5>& distortion);

}  // namespace graspdb::client
