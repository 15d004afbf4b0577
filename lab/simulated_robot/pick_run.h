// A simulated robot: places objects, requests grasps from its cell's agent, and judges them.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/robots/gri/gri_client.h"
#include "recognition/base/types.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::lab {

// Error of a tool pose from the nearest taught grasp of all objects in a scene.
struct PickError {
  std::string object;  // id; empty where there is no grasp in the scene
  std::string grasp_id;
  double shift_m = 0;
  double turn_rad = 0;
};

bool WouldHold(const PickError& error);

// Compares `world_tcp` (T_world_tcp) to the grasps of the objects in `scene`, modulo the symmetry
// of each workpiece about its z axis.
PickError JudgePick(const std::vector<rendering::Workpiece>& parts,
                    const rendering::PlannedCapture& scene, const recognition::Pose& world_tcp);

struct PickRunOptions {
  std::filesystem::path scene;  // the folder that the agent's simulated camera reads
  int picks = 20;
  int objects_per_scene = 1;
  std::uint64_t seed = 1;
  int job = 1;
  int pose_format = 4;
  recognition::Pose world_base = recognition::Pose::Identity();  // T_world_base
  // Jobs that report the result of a pick to the agent.
  std::optional<int> picked_job = {};
  std::optional<int> missed_job = {};
};

struct Pick {
  std::string shown;  // id of the object that the scene is about
  client::GriCode code = client::GriCode::kUnknownError;
  PickError error;  // if a pose was returned
  bool held = false;
  // From the trigger to the answer, also without a pose, without the camera's time.
  std::chrono::duration<double> latency{};
};

// Picks and calls `on_pick` for each. The scenes show each of `parts` in turn. A request without a
// pose is no error and is not reported to the agent. Errors of PlanRandomScenes, WriteScenes and
// GriClient; INTERNAL when the agent returns an invalid pose; FAILED_PRECONDITION when a job that
// reports picks returns an error. Thread-safe if every thread has its own client and folder.
absl::StatusOr<std::vector<Pick>> RunPicks(client::GriClient& agent,
                                           const std::vector<rendering::Workpiece>& parts,
                                           const PickRunOptions& options,
                                           const std::function<void(const Pick&)>& on_pick);

}  // namespace graspdb::lab
