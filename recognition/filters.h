// The filters between the region and the clusters.
#pragma once

#include "recognition/point_search.h"
#include "recognition/types.h"

namespace graspdb::recognition {

// Statistical outlier removal (Rusu et al. 2008): positions of the points whose
// mean distance to their `neighbor_count` nearest neighbours is at most the mean
// of all such distances plus `deviation_factor` standard deviations. All points
// when there are not more than `neighbor_count` of them.
Indices RemoveStatisticalOutliers(const Points& points, int neighbor_count,
                                  double deviation_factor);

// A cloud thinned to one point a voxel.
struct VoxelCloud {
  Points points;                       // the centroid of each occupied voxel
  std::vector<std::int32_t> voxel_of;  // for each input point the position of its voxel
};

// Voxel grid: cubes of edge `voxel_size_m`, aligned with the origin, each
// replaced by the centroid of its points (paper, section 3.1). The voxels come
// out in the order of their coordinates (z, y, x), whatever the order of the
// input. Points must be finite and within 10 km of the origin.
VoxelCloud DownsampleToVoxels(const Points& points, double voxel_size_m);

// Normals by principal component analysis of the points within `radius_m`, turned
// towards `viewpoint`. A point with fewer than three neighbours gets the
// direction to the viewpoint, or z where it is the viewpoint itself.
Normals EstimateNormals(const Points& points, const PointSearch& search,
                        const Eigen::Vector3d& viewpoint, double radius_m);

}  // namespace graspdb::recognition
