#include "recognition/points/depth_image.h"

#include <limits>

namespace graspdb::recognition {

Eigen::Vector3f PointAt(const DepthImage& image, std::size_t pixel) {
  const std::uint16_t count = image.depth[pixel];
  if (count == 0) return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  const auto width = static_cast<std::size_t>(image.camera.width);
  const float z = static_cast<float>(count) * static_cast<float>(image.unit_m);
  return {ColumnOf(image.camera, pixel % width) * z, RowOf(image.camera, pixel / width) * z, z};
}

Points PointsOf(const DepthImage& image) {
  Points points;
  points.reserve(image.depth.size());
  for (std::size_t i = 0; i < image.depth.size(); ++i) points.push_back(PointAt(image, i));
  return points;
}

}  // namespace graspdb::recognition
