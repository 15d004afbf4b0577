// Thinning to one point a voxel.
#pragma once

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"

namespace graspdb::recognition {

// A cloud thinned to one point a voxel.
struct VoxelCloud {
  Points points;                       // the centroid of each occupied voxel
  std::vector<std::int32_t> voxel_of;  // for each input point the position of its voxel
};

// Voxel grid: cubes of edge `voxel_size_m`, aligned with the origin, each replaced by the centroid
// of its points (paper, section 3.1). The voxels are in the order of their coordinates (z, y, x),
// whatever the order of the input. Points must be finite and within 1 km of the origin. None once
// cancelled.
VoxelCloud DownsampleToVoxels(const Points& points, double voxel_size_m,
                              const IsCancelled& is_cancelled = {});

// Whether the points are in at least `count` voxels of that grid. Looks at no more of them than
// needed; O(n log count).
bool HasVoxels(const Points& points, double voxel_size_m, std::size_t count);

}  // namespace graspdb::recognition
