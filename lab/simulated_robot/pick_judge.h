// Whether a pick of a simulated robot would have held.
#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "recognition/base/types.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::lab {

// Error of a tool pose from the nearest taught grasp of all objects in a scene.
struct PickError {
  std::string object;  // id; empty where there is no grasp in the scene
  std::string grasp_id;
  double shift_m = 0;
  double turn_rad = 0;
};

// Tolerances of a gripper.
inline constexpr double kHoldShiftM = 0.003;
inline constexpr double kHoldTurnRad = 2 * std::numbers::pi / 180;

bool WouldHold(const PickError& error);

// Compares `world_tcp` (T_world_tcp) to the grasps of the objects in `scene`, modulo the symmetry
// of each workpiece about its z axis.
PickError JudgePick(const std::vector<rendering::Workpiece>& parts,
                    const rendering::PlannedCapture& scene, const recognition::Pose& world_tcp);

}  // namespace graspdb::lab
