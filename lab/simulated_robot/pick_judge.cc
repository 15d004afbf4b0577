#include "lab/simulated_robot/pick_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "files/messages/pose_message.h"

namespace graspdb::lab {
namespace {

using recognition::Pose;

// Of the turns about z that the symmetry allows, the one that takes `taught` nearest to `found`.
double NearestTurn(int symmetry_order, const Eigen::Matrix3d& taught,
                   const Eigen::Matrix3d& found) {
  if (symmetry_order == 1) return 0;
  const Eigen::Matrix3d between = found * taught.transpose();
  const double turn = std::atan2(between(1, 0) - between(0, 1), between(0, 0) + between(1, 1));
  if (symmetry_order == 0) return turn;
  const double step = 2 * std::numbers::pi / symmetry_order;
  return step * std::round(turn / step);
}

PickError ErrorOf(const rendering::Workpiece& part, const v1::Grasp& grasp,
                  const Pose& object_tcp) {
  const Pose taught = files::FromMessage(grasp.tcp_pose());
  Pose turned = Pose::Identity();
  turned.rotate(
      Eigen::AngleAxisd(NearestTurn(part.symmetry_order, taught.linear(), object_tcp.linear()),
                        Eigen::Vector3d::UnitZ()));
  const Pose between = (turned * taught).inverse() * object_tcp;
  return {.object = part.object_id,
          .grasp_id = grasp.grasp_id(),
          .shift_m = between.translation().norm(),
          .turn_rad = Eigen::AngleAxisd(between.linear()).angle()};
}

double SizeOf(const PickError& error) {
  return std::max(error.shift_m / kHoldShiftM, error.turn_rad / kHoldTurnRad);
}

}  // namespace

bool WouldHold(const PickError& error) { return !error.object.empty() && SizeOf(error) <= 1; }

PickError JudgePick(const std::vector<rendering::Workpiece>& parts,
                    const rendering::PlannedCapture& scene, const Pose& world_tcp) {
  PickError nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const rendering::Placement& placement : scene.placements) {
    const rendering::Workpiece& part = parts[placement.part];
    for (const v1::Grasp& grasp : part.grasps) {
      PickError error = ErrorOf(part, grasp, placement.world_object.inverse() * world_tcp);
      const double size = SizeOf(error);
      if (size >= least) continue;
      least = size;
      nearest = std::move(error);
    }
  }
  return nearest;
}

}  // namespace graspdb::lab
