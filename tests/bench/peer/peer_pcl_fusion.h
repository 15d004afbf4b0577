// Fusion of several views with the Point Cloud Library.
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

namespace graspdb::peer {

// VoxelGrid over all views' points, then MovingLeastSquares of second order with normals, on one
// thread. Metres.
pcl::PointCloud<pcl::PointNormal>::Ptr Fuse(const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& all,
                                            double cell_m, double radius_m);

}  // namespace graspdb::peer
