// Images of a lens as images of a pinhole.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "recognition/base/types.h"

namespace graspdb::client {

// For every pixel of the pinhole image, row by row, the pixel of the lens's image that looks
// nearest to where it looks, or -1 where that is outside. Both have `camera`'s size, focal lengths
// and principal point. Depths are moved as they are: they lie along the axis, and between them
// nothing may be mixed.
//
// `distortion` is that of Brown, "Decentering Distortion of Lenses", Photogrammetric Engineering
// 1966, in OpenCV's order: k1, k2, p1, p2, k3.
std::vector<std::int32_t> LensTable(const recognition::CameraIntrinsics& camera,
                                    const std::array<double, 5>& distortion);

}  // namespace graspdb::client
