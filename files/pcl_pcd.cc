#include "files/pcl_pcd.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <cstdint>
#include <exception>
#include <mutex>
#include <sstream>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace graspdb::client {
namespace {

// PCL prints its errors; they are returned here instead.
void Silence() {
  static std::once_flag once;
  std::call_once(once, [] { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); });
}

template <typename PointT>
pcl::PCLPointCloud2 ToBlob(const PointFile& file, const pcl::PointCloud<PointT>& cloud) {
  pcl::PCLPointCloud2 blob;
  pcl::toPCLPointCloud2(cloud, blob);
  blob.width = static_cast<std::uint32_t>(file.width);
  blob.height = static_cast<std::uint32_t>(file.height);
  blob.row_step = blob.width * blob.point_step;
  return blob;
}

pcl::PCLPointCloud2 ToBlob(const PointFile& file) {
  if (file.normals.empty()) {
    pcl::PointCloud<pcl::PointXYZ> cloud;
    for (const Eigen::Vector3f& p : file.points) cloud.emplace_back(p.x(), p.y(), p.z());
    return ToBlob(file, cloud);
  }
  pcl::PointCloud<pcl::PointNormal> cloud;
  for (std::size_t i = 0; i < file.points.size(); ++i) {
    const Eigen::Vector3f& p = file.points[i];
    const Eigen::Vector3f& n = file.normals[i];
    cloud.emplace_back(p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
  }
  return ToBlob(file, cloud);
}

}  // namespace

absl::StatusOr<std::string> EncodePcd(const PointFile& file) {
  Silence();
  const recognition::Pose pose = file.sensor_pose.value_or(recognition::Pose::Identity());
  Eigen::Vector4f origin = Eigen::Vector4f::Zero();
  origin.head<3>() = pose.translation().cast<float>();
  const Eigen::Quaternionf orientation = Eigen::Quaterniond(pose.linear()).cast<float>();
  try {
    std::ostringstream out;
    if (pcl::PCDWriter().writeBinaryCompressed(out, ToBlob(file), origin, orientation) == 0) {
      return std::move(out).str();
    }
  } catch (const std::exception& e) {
    return absl::InternalError(absl::StrCat("PCL cannot write the cloud: ", e.what()));
  }
  return absl::InternalError("PCL cannot write the cloud");
}

}  // namespace graspdb::client
