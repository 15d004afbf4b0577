#include "recognition/depth_image.h"

#include <limits>

namespace graspdb::recognition {

Points Unproject(std::span<const std::uint16_t> depth, const CameraIntrinsics& camera,
                 double unit_m) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Points points;
  points.reserve(depth.size());
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const std::uint16_t count = depth[points.size()];
      if (count == 0) {
        points.emplace_back(nan, nan, nan);
        continue;
      }
      const double z = count * unit_m;
      points.emplace_back(
          Eigen::Vector3d((u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z)
              .cast<float>());
    }
  }
  return points;
}

}  // namespace graspdb::recognition
