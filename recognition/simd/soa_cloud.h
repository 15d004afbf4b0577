// A cloud laid out for SIMD code.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "recognition/base/types.h"
#include "recognition/simd/kernels.h"

namespace graspdb::recognition {

// Every `stride`th point of a cloud and its normal, each coordinate in an array of its own, padded
// with points that are far from everything. Frame and units of the cloud. Immutable.
class SoaCloud {
 public:
  explicit SoaCloud(const OrientedCloud& cloud, std::size_t stride = 1);

  simd::OrientedCoordinates coordinates() const;
  std::size_t point_count() const { return point_count_; }  // without the padding
  std::size_t stride() const { return stride_; }
  std::size_t bytes() const { return 6 * columns_[0].size() * sizeof(float); }

 private:
  std::size_t point_count_;
  std::size_t stride_;
  std::array<std::vector<float>, 6> columns_;  // x, y, z of points, then of normals
};

}  // namespace graspdb::recognition
