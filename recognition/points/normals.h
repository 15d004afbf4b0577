// Normals of a surface.
#pragma once

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"

namespace graspdb::recognition {

// Normals by principal component analysis of the points within `radius_m`, turned
// towards `viewpoint`. A point with fewer than three neighbours gets the
// direction to the viewpoint, or z where it is the viewpoint itself.
Normals EstimateNormals(const Points& points, const Eigen::Vector3d& viewpoint, double radius_m,
                        const IsCancelled& is_cancelled = {});

}  // namespace graspdb::recognition
