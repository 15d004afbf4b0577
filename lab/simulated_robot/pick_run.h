// A simulated robot at work: it lays objects out, asks its cell's agent, and judges what it is
// told.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/robots/gri_client.h"
#include "lab/simulated_robot/pick_judge.h"

namespace graspdb::client {

struct PickRunOptions {
  std::filesystem::path scene;  // the folder that the agent's simulated camera looks at
  int picks = 20;
  int objects_per_scene = 1;
  std::uint64_t seed = 1;
  int job = 1;
  int pose_format = 4;
  recognition::Pose world_base = recognition::Pose::Identity();  // T_world_base
  // Jobs by which the agent is told how it went.
  std::optional<int> picked_job = {};
  std::optional<int> missed_job = {};
};

struct Pick {
  std::string shown;  // id of the object that the scene is about
  GriCode code = GriCode::kUnknownError;
  PickError error;  // where a pose was given
  bool held = false;
  // From the trigger to the answer, also where that is no pose, without the camera's frame.
  std::chrono::duration<double> cycle{};
};

// Picks; `heard` is told of each. Scenes that show each of `parts` in turn. A request without a
// pose is no error, and nobody is told of it. Errors of PlanRandomScenes, WriteScenes and
// GriClient; INTERNAL when the agent answers what is no pose; FAILED_PRECONDITION when a job that
// is to hear of picks answers with an error. Nothing is shared: threads with a client and a folder
// each may run it.
absl::StatusOr<std::vector<Pick>> RunPicks(GriClient& agent, const std::vector<Workpiece>& parts,
                                           const PickRunOptions& options,
                                           const std::function<void(const Pick&)>& heard);

}  // namespace graspdb::client
