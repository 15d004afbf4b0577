// A known object that a gripper holds before a camera, in all six degrees of freedom.
#pragma once

#include <optional>

#include "client/cell/calibration/target_scan.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {

// Looks for the model in a scan that is cut out around it and what holds it, without table and
// background. Every side that was taught is laid on every part of the scan, turned about the line
// of sight (the world of `scan` is that of its sensor); what fits best is refined. nullopt when
// nothing does. Deterministic; takes about a second.
std::optional<TargetFit> FindGrippedTarget(const recognition::SurfaceModel& model,
                                           const TargetScan& scan);

}  // namespace graspdb::client
