#include "recognition/grasps/grasp_proposals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace graspdb::recognition {
namespace {

constexpr int kMaxTurns = 12;
constexpr double kFreeStep = std::numbers::pi / 6;
constexpr double kSameTurn = 1e-9;

// 0, the steps between the ends, and the ends.
std::vector<double> FreeTurns(const FreeTurn& turn) {
  std::vector<double> out = {0, turn.min_rad};
  const auto first = static_cast<int>(std::ceil(turn.min_rad / kFreeStep));
  for (int k = first; k * kFreeStep < turn.max_rad; ++k) out.push_back(k * kFreeStep);
  out.push_back(turn.max_rad);
  return out;
}

// All turns of a tool, the smallest first, each once.
std::vector<double> TurnsOf(const TaughtGrasp& grasp, int symmetry_order) {
  std::vector<double> declared = DeclaredTurns(symmetry_order);
  if (!grasp.free_turn || symmetry_order == 0) return declared;
  std::vector<double> out;
  for (const double free : FreeTurns(*grasp.free_turn)) {
    for (const double turn : declared) {
      const double sum = std::remainder(turn + free, 2 * std::numbers::pi);
      const auto is_same = [&](double other) {
        return std::abs(std::remainder(sum - other, 2 * std::numbers::pi)) < kSameTurn;
      };
      if (std::ranges::none_of(out, is_same)) out.push_back(sum);
    }
  }
  std::ranges::stable_sort(out, {}, [](double turn) { return std::abs(turn); });
  return out;
}

constexpr std::int64_t kPriorPicks = 20;
constexpr std::int64_t kPriorSuccesses = 18;

struct Picks {
  std::int64_t succeeded = 0;
  std::int64_t tried = 0;
};

Picks WithPrior(const PickCounts& reported) {
  return {.succeeded = reported.picked + kPriorSuccesses,
          .tried = reported.picked + reported.missed + reported.slipped + kPriorPicks};
}

// Tenths, so that only significant outcomes change the order: two failures without a success, or
// twenty successes without a failure.
std::int64_t SuccessClass(const PickCounts& reported) {
  const Picks picks = WithPrior(reported);
  return (20 * picks.succeeded + picks.tried) / (2 * picks.tried);  // rounded, without a float
}

}  // namespace

double SuccessRate(const PickCounts& picks) {
  const Picks all = WithPrior(picks);
  return static_cast<double>(all.succeeded) / static_cast<double>(all.tried);
}

std::vector<double> DeclaredTurns(int symmetry_order) {
  const int order = symmetry_order == 0 ? kMaxTurns : symmetry_order;
  const int count = std::clamp(order, 1, kMaxTurns);
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
  struct Turned {
    GraspProposal proposal;
    double turn = 0;
    std::int64_t success = 0;
  };
  std::vector<Turned> found;
  for (const TaughtGrasp& grasp : stable_pose.grasps) {
    const std::int64_t success = SuccessClass(grasp.picks);
    for (const double turn : TurnsOf(grasp, stable_pose.symmetry_order)) {
      Pose turned = world_object;
      if (turn != 0) turned.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
      const Pose world_tcp = turned * grasp.object_tcp;
      if (workspace && !workspace->Contains(world_tcp.translation())) continue;
      found.push_back({{grasp, world_tcp}, turn, success});
    }
  }
  std::ranges::stable_sort(found, [](const Turned& a, const Turned& b) {
    if (a.proposal.grasp.priority != b.proposal.grasp.priority) {
      return a.proposal.grasp.priority > b.proposal.grasp.priority;
    }
    if (a.success != b.success) return a.success > b.success;
    return std::abs(a.turn) < std::abs(b.turn) - kSameTurn;
  });
  std::vector<GraspProposal> out;
  out.reserve(found.size());
  for (Turned& turned : found) out.push_back(std::move(turned.proposal));
  return out;
}

}  // namespace graspdb::recognition
