#include "client/files/pcl_pcd.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <sstream>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace graspdb::client {
namespace {

// PCL prints its complaints; ours are values.
void Silence() {
  static std::once_flag once;
  std::call_once(once, [] { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); });
}

// Where a floating-point field lies within a point.
struct Column {
  std::size_t offset = 0;
  bool is_double = false;

  float At(const std::uint8_t* point) const {
    if (is_double) {
      double value = 0;
      std::memcpy(&value, point + offset, sizeof(value));
      return static_cast<float>(value);
    }
    float value = 0;
    std::memcpy(&value, point + offset, sizeof(value));
    return value;
  }
};

using Columns = std::array<Column, 3>;

std::optional<Columns> FindColumns(const pcl::PCLPointCloud2& cloud,
                                   const std::array<const char*, 3>& names) {
  Columns columns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    bool found = false;
    for (const pcl::PCLPointField& field : cloud.fields) {
      const bool is_double = field.datatype == pcl::PCLPointField::FLOAT64;
      const bool is_float = field.datatype == pcl::PCLPointField::FLOAT32;
      if (field.name != names[i] || field.count != 1 || (!is_double && !is_float)) continue;
      if (field.offset + (is_double ? 8U : 4U) > cloud.point_step) continue;
      columns[i] = {.offset = field.offset, .is_double = is_double};
      found = true;
      break;
    }
    if (!found) return std::nullopt;
  }
  return columns;
}

std::vector<Eigen::Vector3f> Extract(const pcl::PCLPointCloud2& cloud, const Columns& columns) {
  const std::size_t count = cloud.data.size() / cloud.point_step;
  std::vector<Eigen::Vector3f> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* point = cloud.data.data() + i * cloud.point_step;
    values[i] = {columns[0].At(point), columns[1].At(point), columns[2].At(point)};
  }
  return values;
}

std::optional<pcl::PCLPointCloud2> Decode(const std::filesystem::path& path,
                                          const PcdHeader& header) {
  pcl::PCLPointCloud2 cloud;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0;
  if (pcl::PCDReader().read(path.string(), cloud, origin, orientation, version) < 0) {
    return std::nullopt;
  }
  const auto promised = static_cast<std::size_t>(header.point_count()) * cloud.point_step;
  if (cloud.point_step == 0 || cloud.data.size() != promised) return std::nullopt;
  return cloud;
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

absl::StatusOr<PointFile> DecodePcd(const std::filesystem::path& path, const PcdHeader& header) {
  Silence();
  std::optional<pcl::PCLPointCloud2> cloud;
  std::string why = "its points cannot be unpacked";
  try {
    cloud = Decode(path, header);
  } catch (const std::exception& e) {
    why = absl::StrCat("PCL says: ", e.what());
  }
  const std::optional<Columns> points = cloud ? FindColumns(*cloud, {"x", "y", "z"}) : std::nullopt;
  if (!points) {
    return absl::InvalidArgumentError(
        absl::StrCat(path.string(), " is damaged: ", why, "; copy or capture the cloud again"));
  }
  PointFile file;
  file.points = Extract(*cloud, *points);
  const auto normals = FindColumns(*cloud, {"normal_x", "normal_y", "normal_z"});
  if (normals) file.normals = Extract(*cloud, *normals);
  file.width = header.width;
  file.height = header.height;
  return file;
}

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
