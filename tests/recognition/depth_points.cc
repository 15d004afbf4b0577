#include "tests/recognition/depth_points.h"

namespace graspdb::testing {

recognition::Points PointsOf(const recognition::DepthImage& image) {
  recognition::Points points;
  points.reserve(image.depth.size());
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    points.push_back(recognition::PointAt(image, i));
  }
  return points;
}

}  // namespace graspdb::testing
