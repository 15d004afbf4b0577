#include "client/cell/sensors/simulated/simulated_sensor.h"

#include <algorithm>
#include <utility>

#include "base/status_macros.h"
#include "files/messages/scan_message.h"
#include "rendering/simulation.h"

namespace graspdb::client {
namespace {

constexpr double kDepthUnitM = 0.001;
constexpr int kFirstScenes = 32;

}  // namespace

SceneSource RandomScenes(std::vector<rendering::Workpiece> parts,
                         const rendering::RandomSceneOptions& options) {
  // The first scenes do not depend on the count, so more are planned when needed.
  struct Plan {
    std::vector<rendering::Workpiece> parts;
    rendering::RandomSceneOptions options;
    std::vector<rendering::PlannedCapture> scenes;
    std::size_t next = 0;
  };
  const auto plan = std::make_shared<Plan>(
      Plan{.parts = std::move(parts), .options = options, .scenes = {}, .next = 0});
  return [plan]() -> absl::StatusOr<rendering::PlannedCapture> {
    if (plan->next == plan->scenes.size()) {
      plan->options.count = std::max(kFirstScenes, 2 * static_cast<int>(plan->next));
      ASSIGN_OR_RETURN(plan->scenes, rendering::PlanRandomScenes(plan->parts, plan->options));
    }
    return plan->scenes[plan->next++];
  };
}

SimulatedSensor::SimulatedSensor(rendering::DepthCamera camera,
                                 std::vector<rendering::Workpiece> parts, SceneSource scenes)
    : camera_(std::move(camera)), parts_(std::move(parts)), scenes_(std::move(scenes)) {}

absl::StatusOr<std::unique_ptr<SimulatedSensor>> SimulatedSensor::Create(
    const rendering::DepthCameraModel& camera, std::vector<rendering::Workpiece> parts,
    SceneSource scenes) {
  ASSIGN_OR_RETURN(rendering::DepthCamera created, rendering::DepthCamera::Create(camera));
  return std::unique_ptr<SimulatedSensor>(
      new SimulatedSensor(std::move(created), std::move(parts), std::move(scenes)));
}

absl::StatusOr<rendering::PlannedCapture> SimulatedSensor::Choose() {
  const absl::MutexLock lock(&mutex_);
  ASSIGN_OR_RETURN(rendering::PlannedCapture scene, scenes_());
  RETURN_IF_ERROR(rendering::CheckPlacements(parts_, scene));
  return scene;
}

absl::StatusOr<SensorFrame> SimulatedSensor::Next(MonotonicTime deadline) {
  const MonotonicTime time = MonotonicTime::Now();
  ASSIGN_OR_RETURN(const rendering::PlannedCapture scene, Choose());
  ASSIGN_OR_RETURN(const rendering::DepthFrame frame,
                   camera_.Render(rendering::SceneOf(parts_, scene, /*with_table=*/true),
                                  scene.world_sensor, scene.seed));
  if (MonotonicTime::Now() > deadline) {
    return absl::DeadlineExceededError(
        "the simulated camera took too long to render; raise the time limit");
  }
  SensorFrame out = {.scan = files::DepthMessage(rendering::ToCounts(frame, kDepthUnitM),
                                                 camera_.model().intrinsics, kDepthUnitM),
                     .world_sensor = scene.world_sensor};
  SetTime(time, out);
  return out;
}

}  // namespace graspdb::client
