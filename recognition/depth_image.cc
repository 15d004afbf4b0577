#include "recognition/depth_image.h"

#include <limits>

namespace graspdb::recognition {

Eigen::Vector3f PointAt(std::span<const std::uint16_t> depth, const CameraIntrinsics& camera,
                        double unit_m, std::size_t pixel) {
  const std::uint16_t count = depth[pixel];
  if (count == 0) return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  const auto width = static_cast<std::size_t>(camera.width);
  const float z = static_cast<float>(count) * static_cast<float>(unit_m);
  return {ColumnOf(camera, pixel % width) * z, RowOf(camera, pixel / width) * z, z};
}

}  // namespace graspdb::recognition
