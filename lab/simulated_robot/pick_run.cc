#include "lab/simulated_robot/pick_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/robots/gri/gri_message.h"
#include "files/messages/pose_message.h"
#include "rendering/scene_file.h"

namespace graspdb::lab {
namespace {

using recognition::Pose;

// Tolerances of a gripper.
inline constexpr double kHoldShiftM = 0.003;

inline constexpr double kHoldTurnRad = 2 * std::numbers::pi / 180;

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

using Clock = std::chrono::steady_clock;

client::GriRequest RequestFor(const PickRunOptions& options, int job) {
  client::GriRequest out;
  out.action = static_cast<std::uint8_t>(client::GriAction::kTriggerJobSync);
  out.job_id = static_cast<std::uint16_t>(job);
  out.pose_format = static_cast<std::uint8_t>(options.pose_format);
  return out;
}

absl::Status Report(client::GriClient& agent, const PickRunOptions& options, bool held) {
  const std::optional<int>& job = held ? options.picked_job : options.missed_job;
  if (!job) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto answer, agent.Call(RequestFor(options, *job)));
  if (answer.code == client::GriCode::kNoError ||
      answer.code == client::GriCode::kNoReturnSpecified) {
    return absl::OkStatus();
  }
  return absl::FailedPreconditionError(
      absl::StrCat("job ", *job, ", which reports picks that ", held ? "held" : "did not hold",
                   ", returned ", client::GriCodeName(answer.code), "; see the agent's jobs"));
}

absl::StatusOr<Pick> PickFrom(client::GriClient& agent,
                              const std::vector<rendering::Workpiece>& parts,
                              const PickRunOptions& options,
                              const rendering::PlannedCapture& scene) {
  Pick out;
  out.shown = parts[scene.placements.front().part].object_id;
  const Clock::time_point sent = Clock::now();
  const auto answer = agent.Call(RequestFor(options, options.job));
  const Clock::duration spent = Clock::now() - sent;
  if (!answer.ok()) return answer.status();
  out.code = answer->code;
  out.latency = spent - std::chrono::microseconds(answer->data[client::gri_data::kCameraTime]);
  if (answer->code != client::GriCode::kNoError) return out;
  const absl::StatusOr<Pose> base_tcp = client::FromGriPose(answer->pose, answer->pose_format);
  if (!base_tcp.ok()) return absl::InternalError(base_tcp.status().message());
  out.error = JudgePick(parts, scene, options.world_base * *base_tcp);
  out.held = WouldHold(out.error);
  RETURN_IF_ERROR(Report(agent, options, out.held));
  return out;
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

absl::StatusOr<std::vector<Pick>> RunPicks(client::GriClient& agent,
                                           const std::vector<rendering::Workpiece>& parts,
                                           const PickRunOptions& options,
                                           const std::function<void(const Pick&)>& on_pick) {
  rendering::RandomSceneOptions random;
  random.count = options.picks;
  random.objects_per_scene = options.objects_per_scene;
  random.seed = options.seed;
  ASSIGN_OR_RETURN(const std::vector<rendering::PlannedCapture> scenes,
                   rendering::PlanRandomScenes(parts, random));
  std::vector<Pick> out;
  out.reserve(scenes.size());
  for (const rendering::PlannedCapture& scene : scenes) {
    RETURN_IF_ERROR(rendering::WriteScenes(options.scene, parts, {scene}));
    ASSIGN_OR_RETURN(Pick pick, PickFrom(agent, parts, options, scene));
    on_pick(pick);
    out.push_back(std::move(pick));
  }
  return out;
}

}  // namespace graspdb::lab
