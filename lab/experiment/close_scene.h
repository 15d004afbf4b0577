// Scenes in which objects stand close together.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "rendering/capture_plan.h"

namespace graspdb::client {

struct CloseSceneOptions {
  CameraStand stand = {};
  int count = 0;
  int objects_per_scene = 3;
  // Smallest distance over the table between neighbours, m.
  double gap_m = 0.03;
  // The middle of a scene has |x| and |y| up to this.
  double area_half_width_m = 0.10;
  std::uint64_t seed = 1;
};

// Every scene shows workpieces of different objects, turned anyhow, each `gap_m` away from the
// nearest of the others. All stand within the region of interest; objects that are too large for
// that are passed over. The same arguments give the same plan. FAILED_PRECONDITION where no
// place is found.
absl::StatusOr<std::vector<PlannedCapture>> PlanCloseScenes(const std::vector<Workpiece>& parts,
                                                            const CloseSceneOptions& options);

}  // namespace graspdb::client
