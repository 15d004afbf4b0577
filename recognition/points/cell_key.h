// Cells of points, and the sides of surfaces in them.
#pragma once

#include <cstdint>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// Minimum cosine between normals of one side of a surface in a cell; with less they face opposite
// directions, as the two sides of a sheet.
inline constexpr float kSameSide = 0.3F;

// Of the cubic cell of edge `cell_m` that `p` is in; different within a million cells of the
// origin.
inline std::uint64_t CellKey(const Eigen::Vector3f& p, float cell_m) {
  const Eigen::Vector3i c = (p / cell_m).array().floor().cast<int>();
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    key = (key << 21) | (static_cast<std::uint64_t>(c[axis] + (1 << 20)) & 0x1fffff);
  }
  return key;
}

}  // namespace graspdb::recognition
