// The viewpoint feature histogram as the Point Cloud Library 1.13 computes it.
#pragma once

#include "recognition/descriptors/descriptor.h"

namespace graspdb::recognition {

// VFH-308: 3 x 45 shape bins, 45 distance bins (empty by PCL's default) and 128 viewpoint bins, 100
// a part. Follows PCL where it departs from the paper: the mean normal is not normalised, each pair
// of normals is ordered by its angle to the line between the points, all three angles are binned
// over [-pi, pi], and the direction to the viewpoint is divided by sqrt(d^2 + 1).
Descriptor DescribeVfh308(const OrientedCloud& cloud, const Eigen::Vector3d& viewpoint);

}  // namespace graspdb::recognition
