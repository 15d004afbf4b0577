// Our clouds as PCL's.
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "recognition/base/types.h"

namespace graspdb::testing {

inline pcl::PointCloud<pcl::PointXYZ>::Ptr ToPcl(const recognition::Points& points) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr out(new pcl::PointCloud<pcl::PointXYZ>);
  for (const auto& p : points) out->push_back({p.x(), p.y(), p.z()});
  return out;
}

inline pcl::PointCloud<pcl::Normal>::Ptr ToPclNormals(const recognition::Normals& normals) {
  pcl::PointCloud<pcl::Normal>::Ptr out(new pcl::PointCloud<pcl::Normal>);
  for (const auto& n : normals) out->push_back({n.x(), n.y(), n.z()});
  return out;
}

}  // namespace graspdb::testing
