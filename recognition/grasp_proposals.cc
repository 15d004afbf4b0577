#include "recognition/grasp_proposals.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace graspdb::recognition {
namespace {

constexpr int kMostTurns = 12;

}  // namespace

std::vector<double> DeclaredTurns(int symmetry_order) {
  const int order = symmetry_order == 0 ? kMostTurns : symmetry_order;
  const int count = std::clamp(order, 1, kMostTurns);
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double step = std::round(static_cast<double>(k) * order / count);
    out.push_back(std::remainder(2 * std::numbers::pi * step / order, 2 * std::numbers::pi));
  }
  std::ranges::stable_sort(out, {}, [](double turn) { return std::abs(turn); });
  return out;
}

std::vector<GraspProposal> ProposeGrasps(const TaughtStablePose& stable_pose,
                                         const Pose& world_object,
                                         const std::optional<Box>& workspace) {
  std::vector<GraspProposal> out;
  for (const double turn : DeclaredTurns(stable_pose.symmetry_order)) {
    Pose turned = world_object;
    if (turn != 0) turned.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
    for (const TaughtGrasp& grasp : stable_pose.grasps) {
      const Pose world_tcp = turned * grasp.object_tcp;
      if (workspace && !workspace->Contains(world_tcp.translation())) continue;
      out.push_back({grasp, world_tcp});
    }
  }
  std::ranges::stable_sort(out, std::greater(),
                           [](const GraspProposal& p) { return p.grasp.priority; });
  return out;
}

}  // namespace graspdb::recognition
