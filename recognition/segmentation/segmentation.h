// From a sensor frame to the points of each object: region of interest, table
// plane, outliers, voxels, clusters, normals (paper, section 3.1). Teaching and
// recognising use the same code.
#pragma once

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/cancellation.h"
#include "recognition/base/stages.h"
#include "recognition/base/types.h"
#include "recognition/descriptors/descriptor.h"
#include "recognition/points/plane.h"
#include "recognition/points/scan.h"
#include "recognition/segmentation/segmentation_parameters.h"

namespace graspdb::recognition {

// Source of the world frame.
enum class WorldFrame {
  kGiven,          // Scan::world_sensor.
  kDominantPlane,  // The table before the sensor, see WorldFromPlane.
  kSensor,         // The sensor's own frame: no pose is known, and the scan shows no table.
};

// One object on the table.
struct Segment {
  Indices indices;      // its points in the scan
  OrientedCloud cloud;  // its voxels, world frame, normals towards the sensor
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // of `cloud`, world frame
  bool too_large = false;                              // to be one object, see IsTooLarge
};

// Default T_world_object of a taught object: the centroid, on the table where there may be one.
Pose DefaultObjectPose(WorldFrame frame, const Segment& segment);

// Outcome of a segmentation.
enum class SegmentationOutcome { kFound, kEmptyRegion, kNoCluster };

struct Segmentation {
  SegmentationOutcome outcome = SegmentationOutcome::kNoCluster;
  Pose world_sensor = Pose::Identity();
  WorldFrame world_frame = WorldFrame::kGiven;
  std::optional<Box> region =
      {};  // that was used, world frame; absent: a segmented scan, all of it
  std::optional<Plane> table = {};  // world frame; absent when no plane was found
  double table_noise_m = 0;         // root mean square distance of its points from it; 0: no table
  double table_reach_m = 0;         // height above it up to which points were removed; 0: no table
  double voxel_size_m = 0.003;      // of the segments' clouds
  std::vector<Segment> segments;    // the nearest to the sensor first
  // Points of a segmented scan that are too far from the others to be of one object; left out.
  std::size_t far_point_count = 0;

  // Whether the world's z axis is up. Otherwise objects may lie in any way.
  bool HasGravity() const { return world_frame != WorldFrame::kSensor; }
};

// Limit for the voxels of a scan besides the table: about what three sides of a cube of 1 m have at
// 3 mm, several times those of a tabletop full of objects. Doubled, a scan takes up to 3 s.
inline constexpr std::size_t kMaxVoxels = 300'000;

// Finds the objects in a scan and appends a report of each step to `log`. Steps "range" and
// "extent" are logged where points were left out: those beyond max_range_m, and those of a
// segmented scan that are farther than max_object_size_m from the median. Where outliers would take
// too long to find (outliers.h), their step removes none.
//
// O(n log n) in the points of the scan; cancelled within some milliseconds.
//
// Without a plane in the region nothing is removed as table. A scan that is `segmented` is one
// segment, whatever it contains, as long as it has min_cluster_point_count voxels. With a
// normal_radius_m of 0 the segments have no normals.
// A scan without a sensor pose and without a table is segmented in the sensor's frame, up to 1.5 m
// from it (docs/adr/0040-frames-without-a-table.md). FAILED_PRECONDITION when it has a region,
// which is relative to the table, or shows nothing that near; INVALID_ARGUMENT when there are more
// than kMaxVoxels; CANCELLED.
absl::StatusOr<Segmentation> SegmentScan(const Scan& scan, const SegmentationParameters& parameters,
                                         const DescriptorParameters& descriptor,
                                         const IsCancelled& is_cancelled, StageLog* log);

// FAILED_PRECONDITION: nothing in `scan` says where up is.
absl::Status NoTable(const Scan& scan);

// Voxels and normals of one object's points (world frame, m) as SegmentScan makes them; also for
// stored clouds.
OrientedCloud PrepareCloud(const Points& points, const Eigen::Vector3d& viewpoint,
                           const DescriptorParameters& parameters);

// Mean of the points, in their frame; zero without points.
Eigen::Vector3d Centroid(const Points& points);

// The points moved by T_a_b from frame b to frame a; those of a vector that is moved in, in place.
Points Transform(const Pose& a_b, Points points);

}  // namespace graspdb::recognition
