#include "tests/bench/peer/peer_pcl_fusion.h"

#include <pcl/filters/voxel_grid.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

namespace graspdb::peer {

using pcl::PointNormal;
using pcl::PointXYZ;

pcl::PointCloud<PointNormal>::Ptr Fuse(const pcl::PointCloud<PointXYZ>::ConstPtr& all,
                                       double cell_m, double radius_m) {
  pcl::VoxelGrid<PointXYZ> grid;
  grid.setInputCloud(all);
  const auto leaf = static_cast<float>(cell_m);
  grid.setLeafSize(leaf, leaf, leaf);
  const pcl::PointCloud<PointXYZ>::Ptr means(new pcl::PointCloud<PointXYZ>);
  grid.filter(*means);
  pcl::MovingLeastSquares<PointXYZ, PointNormal> surface;
  surface.setInputCloud(means);
  surface.setSearchMethod(pcl::make_shared<pcl::search::KdTree<PointXYZ>>());
  surface.setSearchRadius(radius_m);
  surface.setPolynomialOrder(2);
  surface.setComputeNormals(true);
  surface.setNumberOfThreads(1);
  pcl::PointCloud<PointNormal>::Ptr out(new pcl::PointCloud<PointNormal>);
  surface.process(*out);
  return out;
}

}  // namespace graspdb::peer
