#include "recognition/simd/soa_cloud.h"

namespace graspdb::recognition {

SoaCloud::SoaCloud(const OrientedCloud& cloud, std::size_t stride)
    : point_count_((cloud.points.size() + stride - 1) / stride), stride_(stride) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns_[axis].assign(simd::Padded(point_count_), simd::kFar);
    columns_[3 + axis].assign(simd::Padded(point_count_), 0);
    for (std::size_t i = 0; i < point_count_; ++i) {
      const auto row = static_cast<Eigen::Index>(axis);
      columns_[axis][i] = cloud.points[i * stride][row];
      columns_[3 + axis][i] = cloud.normals[i * stride][row];
    }
  }
}

simd::OrientedCoordinates SoaCloud::coordinates() const {
  const auto three = [&](std::size_t first) -> simd::Coordinates {
    return {columns_[first].data(), columns_[first + 1].data(), columns_[first + 2].data(),
            columns_[first].size()};
  };
  return {three(0), three(3)};
}

}  // namespace graspdb::recognition
