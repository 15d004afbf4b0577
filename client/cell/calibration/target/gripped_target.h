// The 6-DoF pose of a known object in a gripper.
#pragma once

#include <optional>

#include "client/cell/calibration/target/target_scan.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {

// Searches for the model in a scan that is cropped to it and the gripper, without table and
// background. Tries every taught side at places all over the scan, turned about the line of sight
// (the world frame of `scan` is the sensor frame), and refines the best fits. nullopt when nothing
// fits. Deterministic; takes about a second.
std::optional<TargetFit> FindGrippedTarget(const recognition::SurfaceModel& model,
                                           const TargetScan& scan);

}  // namespace graspdb::client
