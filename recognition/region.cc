#include "recognition/region.h"

#include <cmath>

namespace graspdb::recognition {

bool IsMeasurement(const Eigen::Vector3f& p) {
  constexpr float kFarthest = 100;  // m
  return p.allFinite() && !p.isZero(0) && p.squaredNorm() <= kFarthest * kFarthest;
}

RegionPoints CropToRegion(const Points& scan, const Pose& a_sensor,
                          const std::optional<Box>& region) {
  RegionPoints out;
  const Eigen::Matrix3d rotation = a_sensor.linear();
  const Eigen::Vector3d translation = a_sensor.translation();
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (!IsMeasurement(scan[i])) continue;
    const Eigen::Vector3d p = rotation * scan[i].cast<double>() + translation;
    if (region && !region->Contains(p)) continue;
    out.points.push_back(p.cast<float>());
    out.indices.push_back(static_cast<std::int32_t>(i));
  }
  return out;
}

}  // namespace graspdb::recognition
