// Scenes with objects close together.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "rendering/capture_plan.h"

namespace graspdb::lab {

struct CloseSceneOptions {
  rendering::CameraStand stand = {};
  int count = 0;
  int objects_per_scene = 3;
  // Smallest distance over the table between neighbours, m.
  double gap_m = 0.03;
  // The middle of a scene has |x| and |y| up to this.
  double area_half_width_m = 0.10;
  std::uint64_t seed = 1;
};

// Every scene has workpieces of different objects at random azimuths, each `gap_m` away from its
// nearest neighbour. All are within the region of interest; objects that are too large for it are
// skipped. The same arguments give the same plan. FAILED_PRECONDITION if a scene has no space.
absl::StatusOr<std::vector<rendering::PlannedCapture>> PlanCloseScenes(
    const std::vector<rendering::Workpiece>& parts, const CloseSceneOptions& options);

}  // namespace graspdb::lab
