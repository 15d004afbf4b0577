#include "recognition/region.h"

#include <cmath>

namespace graspdb::recognition {

bool IsMeasurement(const Eigen::Vector3f& p) { return p.allFinite() && !p.isZero(0); }

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
