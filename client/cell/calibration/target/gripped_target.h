// The 6-DoF pose of a known object in a gripper.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "client/cell/calibration/target/target_scan.h"
#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {

// One side of a model, seen by a camera along z.
struct Side {
  Eigen::Matrix3f look_object = Eigen::Matrix3f::Identity();  // z: the line of sight
  recognition::Points points;    // sampled visible points without duplicates, object frame, m
  recognition::Normals normals;  // object frame
  // Indices of distant points that are aligned with places of a scan.
  std::vector<std::size_t> anchors;
};

// The taught sides of a model, all around and from above, some ten degrees apart; without turns
// about the line of sight. The underside is not taught, because objects stand on a table.
std::vector<Side> SidesOf(const recognition::SurfaceModel& model);

// Searches for the model in a scan that is cropped to it and the gripper, without table and
// background. Tries every taught side at places all over the scan, turned about the line of sight
// (the world frame of `scan` is the sensor frame), and refines the best fits. nullopt when nothing
// fits. Deterministic; takes about a second.
std::optional<TargetFit> FindGrippedTarget(const recognition::SurfaceModel& model,
                                           const TargetScan& scan);

}  // namespace graspdb::client
