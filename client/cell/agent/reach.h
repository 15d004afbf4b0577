// The reach of a robot's tool.
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

// Path of the tool: approach along its z axis, grasp, retreat upwards.
struct ToolPath {
  recognition::Pose world_tcp = recognition::Pose::Identity();  // at the grasp
  double approach_distance_m = 0;
  double retreat_distance_m = 0;  // straight up in the world frame
};

// Whether a robot at `world_base` (T_world_base) reaches approach, grasp and retreat.
bool IsWithinReach(const Reach& reach, const recognition::Pose& world_base, const ToolPath& path);

}  // namespace graspdb::client
