// Where the tool may take what was recognised.
#pragma once

#include <optional>
#include <vector>

#include "recognition/models/taught.h"

namespace graspdb::recognition {

// A grasp carried along to where the object stands.
struct GraspProposal {
  TaughtGrasp grasp;
  Pose world_tcp = Pose::Identity();  // T_world_tcp
};

// Turns about z that the declared symmetry allows (TaughtStablePose), rad: 0 first, then by their
// size, at most 12, evenly spread; every 30 degrees where any turn is allowed.
std::vector<double> DeclaredTurns(int symmetry_order);

// The share of picks that succeed, 0 to 1: that of those told, together with twenty imagined ones
// of which eighteen succeeded. So what nothing was told of has 0.9, and few outcomes change little.
double SuccessRate(const PickCounts& picks);

// The grasps of a stable pose that stands at `world_object`, and those that follow from its
// declared symmetry and from their free turns, every 30 degrees up to both ends: the highest
// priority first, of one priority those that succeed as often, within a tenth of SuccessRate,
// before those that succeed less often, of these the least turned first, then as taught. Those
// whose tool centre point lies outside `workspace` (world frame) are left out.
std::vector<GraspProposal> ProposeGrasps(const TaughtStablePose& stable_pose,
                                         const Pose& world_object,
                                         const std::optional<Box>& workspace);

}  // namespace graspdb::recognition
