// Initial poses of a stable pose, before any alignment.
#pragma once

#include <cstdint>
#include <vector>

#include "recognition/models/surface_model.h"
#include "recognition/models/taught.h"
#include "recognition/segmentation/segmentation.h"
#include "recognition/verification/depth_buffer.h"

namespace graspdb::recognition {

// Mean and extent of the visible points, sensor frame, m.
struct Extent {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  Eigen::Vector3f high = Eigen::Vector3f::Zero();
};
Extent ExtentOf(const Points& points, const Eigen::Isometry3f& sensor_points);

// Poses of one view's model that differ in their place.
struct InitialPoses {
  std::vector<Pose> poses;  // T_world_object
  // Of the coarse surface, from about these poses (VisibleSurface::mask).
  std::vector<std::uint8_t> visible;
};

// A segment as the camera sees it.
struct SeenSegment {
  Pose world_sensor = Pose::Identity();                // T_world_sensor
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // world frame, m
  Extent extent = {};
  bool on_table = true;      // z is up, and objects stand as high as they were taught
  double table_reach_m = 0;  // height up to which points were removed as table; 0: none
};

// Approximate turn of those poses about the vertical, from the stable pose's zero, rad: for
// comparing views of one model.
double TurnOf(const TaughtView& view, const SeenSegment& segment);

// T_world_object of the stable pose of `view`, seen from the side that the view shows: turned by
// the change of SideSeen since teaching, with the mean of the visible points of `model` on that of
// the segment. Where sides of the segment are `hidden`, another one that aligns the other edges.
// Where a thin part of the model may have been removed with the table, as a plate with an upright
// leg, one with the mean of the rest on that of the segment.
InitialPoses RoughPoses(const TaughtView& view, const SurfaceModel& model,
                        const SeenSegment& segment, const DepthBuffer::Sides& hidden);

}  // namespace graspdb::recognition
