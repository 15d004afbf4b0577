#include "recognition/points/median_point.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace graspdb::recognition {
namespace {

constexpr std::size_t kMedianSampleSize = 5000;
constexpr float kNearestMedianM = 0.1F;
constexpr float kFarthestMedianM = 2;

Points SampleOf(const Scan& scan, std::size_t step) {
  Points out;
  for (std::size_t i = 0; i < scan.size(); i += step) {
    const Eigen::Vector3f p = scan.PointAt(i);
    if (p.allFinite() && !p.isZero(0)) out.push_back(p);
  }
  return out;
}

}  // namespace

std::optional<Eigen::Vector3f> MedianPoint(const Scan& scan) {
  Points points = SampleOf(scan, std::max<std::size_t>(1, scan.size() / kMedianSampleSize));
  if (points.empty()) points = SampleOf(scan, 1);
  if (points.empty()) return std::nullopt;
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  Eigen::Vector3f out;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::nth_element(points.begin(), middle, points.end(),
                     [&](const auto& a, const auto& b) { return a[axis] < b[axis]; });
    out[axis] = (*middle)[axis];
  }
  return out;
}

bool IsUsualDistance(const Eigen::Vector3f& median) {
  return median.z() >= kNearestMedianM && median.z() <= kFarthestMedianM;
}

std::string WhereMedianIs(const Eigen::Vector3f& median, const std::optional<Pose>& world_sensor) {
  const double z = static_cast<double>(median.z());
  std::string out = absl::StrFormat("the middle of its points is %.*g m %s the sensor", 3,
                                    std::abs(z), z < 0 ? "behind" : "in front of");
  if (world_sensor) {
    const Eigen::Vector3d p = *world_sensor * median.cast<double>();
    absl::StrAppend(&out, absl::StrFormat(", at (%.2f, %.2f, %.2f) m in the world frame, whose "
                                          "table is z = 0",
                                          p.x(), p.y(), p.z()));
  }
  if (z < 0) {
    absl::StrAppend(&out,
                    "; is its z axis backwards, as in OpenGL? The sensor's axes are x right, "
                    "y down, z forward");
  } else if (!IsUsualDistance(median)) {
    absl::StrAppend(&out,
                    "; is the unit right? Coordinates are metres, counts of depth images "
                    "millimetres unless depth_unit_m (depthUnitM in intrinsics.json) states "
                    "another unit");
  }
  return out;
}

std::string AndWhereMedianIs(const Scan& scan, const std::optional<Pose>& world_sensor) {
  const std::optional<Eigen::Vector3f> median = MedianPoint(scan);
  return median ? "; " + WhereMedianIs(*median, world_sensor) : "";
}

}  // namespace graspdb::recognition
