#include "tests/recognition/scenes/pcd_file.h"

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>

#include <cstring>
#include <string>

namespace graspdb::testing {
namespace {

// Copies one four-byte field of a point; false when the cloud has no such field.
template <typename T>
bool CopyField(const pcl::PCLPointCloud2& blob, const std::string& name, std::size_t point,
               T* out) {
  static_assert(sizeof(T) == 4);
  for (const pcl::PCLPointField& field : blob.fields) {
    if (field.name != name) continue;
    std::memcpy(out, &blob.data[point * blob.point_step + field.offset], sizeof(T));
    return true;
  }
  return false;
}

}  // namespace

PcdCloud ReadPcd(const std::filesystem::path& path) {
  pcl::PCLPointCloud2 blob;
  if (pcl::PCDReader().read(path.string(), blob) != 0) {
    ADD_FAILURE() << "not readable: " << path;
    return {};
  }
  PcdCloud out;
  const std::size_t count = std::size_t{blob.width} * blob.height;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3f p;
    EXPECT_TRUE(CopyField(blob, "x", i, &p.x()) && CopyField(blob, "y", i, &p.y()) &&
                CopyField(blob, "z", i, &p.z()));
    out.cloud.points.push_back(p);
    Eigen::Vector3f n;
    if (CopyField(blob, "normal_x", i, &n.x()) && CopyField(blob, "normal_y", i, &n.y()) &&
        CopyField(blob, "normal_z", i, &n.z())) {
      out.cloud.normals.push_back(n);
    }
    std::uint32_t label = 0;
    if (CopyField(blob, "label", i, &label)) out.labels.push_back(label);
  }
  return out;
}

}  // namespace graspdb::testing
