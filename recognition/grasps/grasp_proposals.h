// Grasps of a recognised object.
#pragma once

#include <optional>
#include <vector>

#include "recognition/models/taught.h"

namespace graspdb::recognition {

// A taught grasp at the pose of the recognised object.
struct GraspProposal {
  TaughtGrasp grasp;
  Pose world_tcp = Pose::Identity();  // T_world_tcp
};

// Turns about z that the declared symmetry allows (TaughtStablePose), rad: 0 first, then by their
// size, at most 12, evenly spread; every 30 degrees where any turn is allowed.
std::vector<double> DeclaredTurns(int symmetry_order);

// The share of picks that succeed, 0 to 1: of the reported picks and a prior of twenty, of which
// eighteen succeeded. A grasp without reports has 0.9, and few outcomes change little.
double SuccessRate(const PickCounts& picks);

// The grasps of a stable pose at `world_object`, with the turns of its declared symmetry and their
// free turns, every 30 degrees up to both ends. Sorted by priority, the highest first, then by
// SuccessRate in tenths, then by turn, the smallest first, then as taught. Those whose tool centre
// point lies outside `workspace` (world frame) are left out.
std::vector<GraspProposal> ProposeGrasps(const TaughtStablePose& stable_pose,
                                         const Pose& world_object,
                                         const std::optional<Box>& workspace);

}  // namespace graspdb::recognition
