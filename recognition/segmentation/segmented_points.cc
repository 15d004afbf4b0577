#include "recognition/segmentation/segmented_points.h"

#include <algorithm>
#include <utility>

#include "recognition/descriptors/descriptor.h"
#include "recognition/points/voxels.h"
#include "recognition/segmentation/extent.h"
#include "recognition/segmentation/region.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {

std::optional<Indices> SegmentedPoints(const Scan& scan, const SegmentationParameters& parameters,
                                       double voxel_size_m, const IsCancelled& is_cancelled) {
  if (!scan.segmented) return std::nullopt;
  RegionPoints cloud = CropScan(scan, scan.world_sensor.value_or(Pose::Identity()), scan.region,
                                parameters.max_range_m, is_cancelled);
  // There are at most as many voxels as points, and their box is within that of the points.
  if (cloud.points.size() > kMaxVoxels) return std::nullopt;
  if (IsTooLarge(cloud.points, parameters.max_object_size_m)) return std::nullopt;
  const auto smallest = static_cast<std::size_t>(
      std::max(parameters.min_cluster_point_count, static_cast<int>(kMinDescriptorPoints)));
  if (!HasVoxels(cloud.points, voxel_size_m, smallest) || is_cancelled()) return std::nullopt;
  return std::move(cloud.indices);
}

}  // namespace graspdb::recognition
