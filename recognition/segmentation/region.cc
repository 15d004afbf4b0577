#include "recognition/segmentation/region.h"

#include <algorithm>
#include <array>
#include <limits>

#include "recognition/simd/kernels.h"
#include "recognition/simd/rigid_transform.h"

namespace graspdb::recognition {
namespace {

// The region's corners; unbounded without a region.
struct Bounds {
  explicit Bounds(const std::optional<Box>& region) {
    if (!region) return;
    low = region->min.cast<float>();
    high = region->max.cast<float>();
  }
  Eigen::Vector3f low = Eigen::Vector3f::Constant(-std::numeric_limits<float>::infinity());
  Eigen::Vector3f high = -low;
};

// How many pixels of the row were measured farther away than row.farthest.
std::size_t CountBeyond(const simd::DepthRow& row) {
  const float farthest = row.farthest * row.farthest / (row.unit * row.unit);
  const float beside = 1 + row.row * row.row;
  std::size_t out = 0;
  for (std::size_t u = 0; u < row.width; ++u) {
    const auto count = static_cast<float>(row.counts[u]);
    out += count * count * (beside + row.column[u] * row.column[u]) > farthest ? 1U : 0U;
  }
  return out;
}

}  // namespace

Box DefaultRegion(const Pose& world_sensor) {
  Box region{Eigen::Vector3d(-0.5, -0.5, -0.05), Eigen::Vector3d(0.5, 0.5, 0.6)};
  const Eigen::Vector2d foot = world_sensor.translation().head<2>();
  region.min.head<2>() = region.min.head<2>().cwiseMin(foot);
  region.max.head<2>() = region.max.head<2>().cwiseMax(foot);
  return region;
}

bool IsMeasurement(const Eigen::Vector3f& p) {
  constexpr auto kFarthest = static_cast<float>(kSensorRangeM * kSensorRangeM);
  return !p.isZero(0) && p.squaredNorm() <= kFarthest;  // false for NaN
}

bool HasMeasurement(const Scan& scan) {
  if (!scan.is_image()) return std::ranges::any_of(scan.points, IsMeasurement);
  return std::ranges::any_of(scan.depth_image.depth, [](std::uint16_t count) { return count > 0; });
}

RegionPoints CropToRegion(const Points& scan, const Pose& a_sensor,
                          const std::optional<Box>& region, double max_range_m,
                          const IsCancelled& is_cancelled) {
  RegionPoints out;
  CancellationPoll poll(is_cancelled);
  const auto farthest = static_cast<float>(max_range_m * max_range_m);
  const Bounds bounds(region);
  const RigidTransform motion(a_sensor);
  out.points.reserve(scan.size());
  out.indices.reserve(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (poll.AfterPoints()) break;
    if (scan[i].squaredNorm() > farthest) {  // false for NaN
      out.beyond_range_count += scan[i].allFinite();
      continue;
    }
    // In the order in which images are unprojected, for the same bits.
    const Eigen::Vector3f p = motion.Point(scan[i]);
    // False for NaN.
    const bool inside = p.x() >= bounds.low.x() && p.x() <= bounds.high.x() &&
                        p.y() >= bounds.low.y() && p.y() <= bounds.high.y() &&
                        p.z() >= bounds.low.z() && p.z() <= bounds.high.z();
    if (!inside || !IsMeasurement(scan[i])) continue;
    out.points.push_back(p);
    out.indices.push_back(static_cast<std::int32_t>(i));
  }
  return out;
}

RegionPoints CropImage(const DepthImage& image, const Pose& a_sensor,
                       const std::optional<Box>& region, double max_range_m) {
  const simd::Functions& kernels = simd::Best();
  const auto width = static_cast<std::size_t>(image.camera.width);
  const Bounds bounds(region);
  std::vector<float> columns(width);
  for (std::size_t u = 0; u < width; ++u) columns[u] = ColumnOf(image.camera, u);
  simd::DepthRow row;
  row.width = width;
  row.column = columns.data();
  row.unit = static_cast<float>(image.unit_m);
  row.farthest = static_cast<float>(max_range_m);
  row.world_sensor = RigidTransform(a_sensor).rigid();
  Eigen::Map<Eigen::Vector3f>(row.min) = bounds.low;
  Eigen::Map<Eigen::Vector3f>(row.max) = bounds.high;
  std::array<std::vector<float>, 3> world;
  for (auto& axis : world) axis.resize(width);
  std::vector<std::uint8_t> inside(width);
  Indices found(width);
  RegionPoints out;
  out.points.reserve(image.depth.size());
  out.indices.reserve(image.depth.size());
  for (int v = 0; v < image.camera.height; ++v) {
    const std::size_t first = static_cast<std::size_t>(v) * width;
    row.counts = image.depth.data() + first;
    row.row = RowOf(image.camera, static_cast<std::size_t>(v));
    kernels.unproject(row, world[0].data(), world[1].data(), world[2].data(), inside.data());
    out.beyond_range_count += CountBeyond(row);
    // Without a branch: which pixels are inside is hard to predict.
    std::size_t count = 0;
    for (std::size_t u = 0; u < width; ++u) {
      found[count] = static_cast<std::int32_t>(u);
      count += inside[u];
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto u = static_cast<std::size_t>(found[i]);
      out.points.emplace_back(world[0][u], world[1][u], world[2][u]);
      out.indices.push_back(static_cast<std::int32_t>(first + u));
    }
  }
  return out;
}

RegionPoints CropScan(const Scan& scan, const Pose& a_sensor, const std::optional<Box>& region,
                      double max_range_m, const IsCancelled& is_cancelled) {
  return scan.is_image() ? CropImage(scan.depth_image, a_sensor, region, max_range_m)
                         : CropToRegion(scan.points, a_sensor, region, max_range_m, is_cancelled);
}

}  // namespace graspdb::recognition
