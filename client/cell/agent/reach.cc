#include "client/cell/agent/reach.h"

#include <array>

namespace graspdb::client {

bool IsWithinReach(const Reach& reach, const recognition::Pose& world_base, const ToolPath& path) {
  const Eigen::Vector3d at = path.world_tcp.translation();
  const Eigen::Vector3d before =
      at - path.approach_distance_m * path.world_tcp.linear().col(2).eval();
  const Eigen::Vector3d above = at + path.retreat_distance_m * Eigen::Vector3d::UnitZ();
  for (const Eigen::Vector3d& point : std::array{at, before, above}) {
    const double distance = (point - world_base.translation()).norm();
    if (distance < reach.min_m || distance > reach.max_m) return false;
    if (reach.workspace && !reach.workspace->Contains(point)) return false;
  }
  return true;
}

}  // namespace graspdb::client
