// Whether a simulated robot would have held what it reached for.
#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "recognition/base/types.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// A tool pose against the taught grasp that it is nearest to, of all objects in a scene.
struct PickError {
  std::string object;  // id; empty where there is no grasp in the scene
  std::string grasp_id;
  double shift_m = 0;
  double turn_rad = 0;
};

// A gripper forgives so much.
inline constexpr double kHoldShiftM = 0.003;
inline constexpr double kHoldTurnRad = 2 * std::numbers::pi / 180;

bool WouldHold(const PickError& error);

// `world_tcp` (T_world_tcp) against the grasps of what `scene` has placed, modulo the symmetry of
// each workpiece about its z axis.
PickError JudgePick(const std::vector<Workpiece>& parts, const PlannedCapture& scene,
                    const recognition::Pose& world_tcp);

}  // namespace graspdb::client
