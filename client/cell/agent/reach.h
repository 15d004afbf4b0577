// Where a robot can take its tool.
#pragma once

#include <limits>
#include <optional>

#include "recognition/base/types.h"

namespace graspdb::client {

struct Reach {
  // Distance of the tool centre point from the robot's base, metres.
  double min_m = 0;
  double max_m = std::numeric_limits<double>::infinity();
  // World frame.
  std::optional<recognition::Box> workspace = {};
};

// A way of the tool to a grasp: it begins before it, along the tool's z axis, and ends above it.
struct ToolPath {
  recognition::Pose world_tcp = recognition::Pose::Identity();  // at the grasp
  double approach_distance_m = 0;
  double retreat_distance_m = 0;  // straight up in the world frame
};

// Whether all three ends of the way can be reached by a robot at `world_base` (T_world_base).
bool IsWithinReach(const Reach& reach, const recognition::Pose& world_base, const ToolPath& path);

}  // namespace graspdb::client
