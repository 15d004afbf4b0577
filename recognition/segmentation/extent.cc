#include "recognition/segmentation/extent.h"

#include <algorithm>

#include "recognition/base/bounds.h"

namespace graspdb::recognition {
namespace {

float MedianAlong(const Points& points, Eigen::Index axis) {
  std::vector<float> values(points.size());
  std::ranges::transform(points, values.begin(), [&](const auto& p) { return p[axis]; });
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

bool IsTooLarge(const Points& points, double max_size_m) {
  return !points.empty() && BoundsOf(points).sizes().maxCoeff() > static_cast<float>(max_size_m);
}

std::size_t LeaveOutFarPoints(double max_size_m, RegionPoints* cloud) {
  // Most scans need no median.
  if (!IsTooLarge(cloud->points, max_size_m)) return 0;
  Eigen::Vector3f median;
  for (const Eigen::Index axis : {0, 1, 2}) median[axis] = MedianAlong(cloud->points, axis);
  const auto reach = static_cast<float>(max_size_m);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud->points.size(); ++i) {
    if ((cloud->points[i] - median).cwiseAbs().maxCoeff() > reach) continue;
    cloud->points[kept] = cloud->points[i];
    cloud->indices[kept] = cloud->indices[i];
    ++kept;
  }
  const std::size_t left_out = cloud->points.size() - kept;
  cloud->points.resize(kept);
  cloud->indices.resize(kept);
  return left_out;
}

}  // namespace graspdb::recognition
