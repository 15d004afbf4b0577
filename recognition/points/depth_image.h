// From a depth image to points.
#pragma once

#include <cstdint>
#include <vector>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// A depth camera's image: width x height counts of `unit_m` metres along the sensor's z axis, row
// by row; 0 where nothing was measured.
struct DepthImage {
  std::vector<std::uint16_t> depth;
  CameraIntrinsics camera;
  double unit_m = 0.001;
};

// Where the ray through a column (u) or row (v) of pixels is at a depth of 1 m, sensor frame, m.
inline float ColumnOf(const CameraIntrinsics& camera, std::size_t u) {
  return static_cast<float>((static_cast<double>(u) - camera.cx) / camera.fx);
}
inline float RowOf(const CameraIntrinsics& camera, std::size_t v) {
  return static_cast<float>((static_cast<double>(v) - camera.cy) / camera.fy);
}

// The point of one pixel, sensor frame, m; NaN where the depth is 0.
Eigen::Vector3f PointAt(const DepthImage& image, std::size_t pixel);

// The points of all pixels, row by row.
Points PointsOf(const DepthImage& image);

}  // namespace graspdb::recognition
