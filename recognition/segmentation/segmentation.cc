#include "recognition/segmentation/segmentation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_format.h"
#include "recognition/points/median_point.h"
#include "recognition/points/normals.h"
#include "recognition/points/voxels.h"
#include "recognition/segmentation/clusters.h"
#include "recognition/segmentation/extent.h"
#include "recognition/segmentation/outliers.h"
#include "recognition/segmentation/region.h"
#include "recognition/segmentation/table_pieces.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;

// Search range of the table that defines the world frame, m. Without one, objects are as near.
constexpr double kTableRange = 1.5;
// Maximum gap between parts of one object with unseen space between them, in cluster tolerances.
constexpr double kJoinReach = 2;

template <typename T>
std::vector<T> Select(const std::vector<T>& from, const Indices& which) {
  std::vector<T> out;
  out.reserve(which.size());
  for (const std::int32_t i : which) out.push_back(from[static_cast<std::size_t>(i)]);
  return out;
}

std::vector<double> Heights(const Plane& table, const Points& points) {
  std::vector<double> out;
  out.reserve(points.size());
  for (const auto& p : points) out.push_back(table.Height(p.cast<double>()));
  return out;
}

absl::Status CancelledAfter(const char* step) {
  return absl::CancelledError(std::string("cancelled after ") + step);
}

// `which` ascends.
void Keep(const Indices& which, RegionPoints* cloud) {
  const auto keep = [&](auto& of) {
    for (std::size_t i = 0; i < which.size(); ++i) of[i] = of[static_cast<std::size_t>(which[i])];
    of.resize(which.size());
  };
  keep(cloud->points);
  keep(cloud->indices);
}

// T_world_sensor from the dominant plane in front of the sensor; nullopt where there is no table.
std::optional<Pose> WorldFromTable(const Scan& scan, const SegmentationParameters& parameters) {
  const Vector3d reach = Vector3d::Constant(kTableRange);
  Points near = CropScan(scan, Pose::Identity(), Box{-reach, reach}).points;
  std::erase_if(near, [](const auto& p) { return p.squaredNorm() >= kTableRange * kTableRange; });
  PlaneConstraint constraint;
  constraint.distance_m = parameters.plane_distance_m;
  constraint.min_share = parameters.plane_min_share;
  const std::optional<Plane> table = FindPlane(near, Vector3d::Zero(), constraint);
  if (!table || !IsWideEnough(*table, near, constraint.distance_m)) return std::nullopt;
  return WorldFromPlane(*table, Vector3d::Zero(), Vector3d::UnitZ(), Vector3d::UnitX());
}

// Also sets the region.
absl::Status FindWorldFrame(const Scan& scan, const SegmentationParameters& parameters,
                            Segmentation* out) {
  if (scan.world_sensor) {
    out->world_sensor = *scan.world_sensor;
    out->world_frame = WorldFrame::kGiven;
  } else if (const auto pose = scan.segmented ? std::nullopt : WorldFromTable(scan, parameters)) {
    out->world_sensor = *pose;
    out->world_frame = WorldFrame::kDominantPlane;
  } else {
    out->world_frame = WorldFrame::kSensor;
  }
  out->region = scan.region;
  if (out->region || scan.segmented) {
    return out->HasGravity() || scan.segmented ? absl::OkStatus() : NoTable(scan);
  }
  const Vector3d reach = Vector3d::Constant(kTableRange);
  out->region = out->HasGravity() ? DefaultRegion(out->world_sensor) : Box{-reach, reach};
  return absl::OkStatus();
}

// Removes the table and points below it. Keeps all when there is no table.
void RemoveTable(const SegmentationParameters& parameters, RegionPoints* cloud, Segmentation* out) {
  PlaneConstraint constraint;
  constraint.distance_m = parameters.plane_distance_m;
  constraint.min_share = parameters.plane_min_share;
  constraint.max_tilt_rad = parameters.plane_max_tilt_rad;
  constraint.max_offset_m = parameters.plane_max_offset_m;
  out->table = FindPlane(cloud->points, out->world_sensor.translation(), constraint);
  if (out->table && !IsSurface(*out->table, cloud->points, constraint.distance_m)) {
    out->table.reset();
  }
  if (!out->table) return;
  out->table_reach_m = parameters.plane_distance_m;
  Indices above;
  double squares = 0;
  double inliers = 0;
  for (std::size_t i = 0; i < cloud->points.size(); ++i) {
    const double height = out->table->Height(cloud->points[i].cast<double>());
    if (height > out->table_reach_m) {
      above.push_back(static_cast<std::int32_t>(i));
    } else if (height > -out->table_reach_m) {
      squares += height * height;
      inliers += 1;
    }
  }
  out->table_noise_m = inliers > 0 ? std::sqrt(squares / inliers) : 0;
  Keep(above, cloud);
}

// The voxels as one cluster each, with their normals and the scan's points.
std::vector<Segment> MakeSegments(const RegionPoints& cloud, const VoxelCloud& voxels,
                                  const std::vector<Indices>& clusters, const Vector3d& viewpoint,
                                  const SegmentationParameters& parameters,
                                  const DescriptorParameters& descriptor,
                                  const IsCancelled& is_cancelled, StageLog* log) {
  std::vector<std::int32_t> cluster_of(voxels.points.size(), -1);
  std::vector<Segment> segments(clusters.size());
  Normals normals;
  if (descriptor.normal_radius_m > 0) {
    log->Measure("normals", voxels.points.size(), [&] {
      normals = EstimateNormals(voxels.points, viewpoint, descriptor.normal_radius_m, is_cancelled);
      return normals.size();
    });
  }
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    segments[c].cloud.points = Select(voxels.points, clusters[c]);
    if (!normals.empty()) segments[c].cloud.normals = Select(normals, clusters[c]);
    segments[c].centroid = Centroid(segments[c].cloud.points);
    segments[c].too_large = IsTooLarge(segments[c].cloud.points, parameters.max_object_size_m);
    for (const std::int32_t v : clusters[c]) {
      cluster_of[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(c);
    }
  }
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::int32_t c = cluster_of[static_cast<std::size_t>(voxels.voxel_of[i])];
    if (c >= 0) segments[static_cast<std::size_t>(c)].indices.push_back(cloud.indices[i]);
  }
  std::stable_sort(segments.begin(), segments.end(), [&](const Segment& a, const Segment& b) {
    return (a.centroid - viewpoint).squaredNorm() < (b.centroid - viewpoint).squaredNorm();
  });
  return segments;
}

// A step of its own where points were left out; `kept` is what remains.
void LogLeftOut(const char* stage, std::size_t kept, std::size_t left_out, StageLog* log) {
  if (left_out > 0) log->Measure(stage, kept + left_out, [&] { return kept; });
}

// The voxels of each object.
std::vector<Indices> ClusterVoxels(const Points& voxels, bool segmented,
                                   const SegmentationParameters& parameters,
                                   const std::optional<Plane>& table,
                                   const IsCancelled& is_cancelled) {
  const auto smallest = static_cast<std::size_t>(
      std::max(parameters.min_cluster_point_count, static_cast<int>(kMinDescriptorPoints)));
  if (segmented) {
    if (voxels.size() < smallest) return {};
    Indices all(voxels.size());
    std::iota(all.begin(), all.end(), 0);
    return {std::move(all)};
  }
  std::vector<Indices> out =
      FindClusters(voxels, parameters.cluster_tolerance_m, smallest, is_cancelled);
  if (!table) return out;
  return JoinUnsupported(voxels, Heights(*table, voxels), std::move(out),
                         kJoinReach * parameters.cluster_tolerance_m, is_cancelled);
}

absl::Status TooManyVoxels(std::size_t count, double voxel_size_m) {
  return absl::InvalidArgumentError(absl::StrFormat(
      "the region of interest holds %d voxels of %g mm besides the table, and at most %d can be "
      "segmented; give a smaller region, or start the server with a larger --voxel-size",
      count, voxel_size_m * 1e3, kMaxVoxels));
}

// Outliers, voxels, clusters and normals of the points above the table.
absl::Status FindSegments(RegionPoints cloud, const Scan& scan,
                          const SegmentationParameters& parameters,
                          const DescriptorParameters& descriptor, const IsCancelled& is_cancelled,
                          StageLog* log, Segmentation* out) {
  VoxelCloud voxels;
  const auto downsample = [&] {
    voxels = DownsampleToVoxels(cloud.points, descriptor.voxel_size_m, is_cancelled);
    return voxels.points.size();
  };
  if (!scan.segmented) {
    // Rejected scans skip the outlier removal, which takes longest.
    if (cloud.points.size() > kMaxVoxels && downsample() > kMaxVoxels) {
      return TooManyVoxels(voxels.points.size(), descriptor.voxel_size_m);
    }
    if (is_cancelled()) return CancelledAfter("the table plane");
    log->Measure("outliers", cloud.points.size(), [&] {
      const Eigen::Vector3f viewpoint = out->world_sensor.translation().cast<float>();
      const std::optional<Indices> kept =
          RemoveStatisticalOutliers(cloud.points, parameters.outlier_neighbor_count,
                                    parameters.outlier_deviation_factor, is_cancelled, &viewpoint);
      if (kept) Keep(*kept, &cloud);
      return cloud.points.size();
    });
  }
  if (is_cancelled()) return CancelledAfter("the outliers");
  log->Measure("voxels", cloud.points.size(), downsample);
  if (is_cancelled()) return CancelledAfter("the voxels");
  if (voxels.points.size() > kMaxVoxels) {
    return TooManyVoxels(voxels.points.size(), descriptor.voxel_size_m);
  }
  std::vector<Indices> clusters;
  log->Measure("clusters", voxels.points.size(), [&] {
    clusters = ClusterVoxels(voxels.points, scan.segmented, parameters, out->table, is_cancelled);
    std::size_t kept = 0;
    for (const Indices& cluster : clusters) kept += cluster.size();
    return kept;
  });
  if (is_cancelled()) return CancelledAfter("the clusters");
  if (clusters.empty()) return absl::OkStatus();
  out->segments = MakeSegments(cloud, voxels, clusters, out->world_sensor.translation(), parameters,
                               descriptor, is_cancelled, log);
  out->outcome = SegmentationOutcome::kFound;
  RemoveTablePieces(scan, is_cancelled, log, out);
  if (is_cancelled()) return CancelledAfter("the normals");
  return absl::OkStatus();
}

}  // namespace

Pose DefaultObjectPose(WorldFrame frame, const Segment& segment) {
  Pose out = Pose::Identity();
  out.translation() = segment.centroid;
  if (frame != WorldFrame::kSensor) out.translation().z() = 0;
  return out;
}

absl::Status NoTable(const Scan& scan) {
  return absl::FailedPreconditionError(
      "the sensor pose is not known and the scan shows no table plane within 1.5 m; give a sensor "
      "pose or a calibrated cell" +
      AndWhereMedianIs(scan, std::nullopt));
}

Eigen::Vector3d Centroid(const Points& points) {
  Vector3d sum = Vector3d::Zero();
  for (const auto& p : points) sum += p.cast<double>();
  return points.empty() ? sum : Vector3d(sum / static_cast<double>(points.size()));
}

Points Transform(const Pose& a_b, Points points) {
  for (auto& p : points) p = (a_b * p.cast<double>()).cast<float>();
  return points;
}

OrientedCloud PrepareCloud(const Points& points, const Eigen::Vector3d& viewpoint,
                           const DescriptorParameters& parameters) {
  OrientedCloud out;
  out.points = DownsampleToVoxels(points, parameters.voxel_size_m).points;
  out.normals = EstimateNormals(out.points, viewpoint, parameters.normal_radius_m);
  return out;
}

absl::StatusOr<Segmentation> SegmentScan(const Scan& scan, const SegmentationParameters& parameters,
                                         const DescriptorParameters& descriptor,
                                         const IsCancelled& cancelled_by_caller, StageLog* log) {
  const IsCancelled is_cancelled = Latched(cancelled_by_caller);
  Segmentation out;
  out.voxel_size_m = descriptor.voxel_size_m;
  RegionPoints cloud;
  absl::Status status;
  log->Measure("region", scan.size(), [&] {
    if (!HasMeasurement(scan)) return std::size_t{0};
    status = FindWorldFrame(scan, parameters, &out);
    if (!status.ok()) return std::size_t{0};
    cloud = CropScan(scan, out.world_sensor, out.region, parameters.max_range_m, is_cancelled);
    return cloud.points.size();
  });
  if (!status.ok()) return status;
  if (is_cancelled()) return CancelledAfter("the region of interest");
  LogLeftOut("range", cloud.points.size(), cloud.beyond_range_count, log);
  if (cloud.points.empty()) {
    const bool is_far = !out.HasGravity() && !scan.segmented && HasMeasurement(scan);
    if (is_far) return NoTable(scan);
    out.outcome = SegmentationOutcome::kEmptyRegion;
    return out;
  }
  if (scan.segmented) {
    out.far_point_count = LeaveOutFarPoints(parameters.max_object_size_m, &cloud);
    LogLeftOut("extent", cloud.points.size(), out.far_point_count, log);
  } else if (out.HasGravity()) {
    log->Measure("plane", cloud.points.size(), [&] {
      RemoveTable(parameters, &cloud, &out);
      return cloud.points.size();
    });
  }
  if (is_cancelled()) return CancelledAfter("the table plane");
  status = FindSegments(std::move(cloud), scan, parameters, descriptor, is_cancelled, log, &out);
  if (!status.ok()) return status;
  return out;
}

}  // namespace graspdb::recognition
