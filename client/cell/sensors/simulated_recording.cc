#include "client/cell/sensors/simulated_recording.h"

#include "client/cell/sensors/fakenect_recording.h"
#include "client/cell/sensors/kinect_v1_calibration.h"
#include "rendering/scene_file.h"
#include "rendering/simulation.h"

namespace graspdb::client {

absl::Status WriteSimulatedRecording(const std::filesystem::path& folder,
                                     const std::vector<rendering::Workpiece>& parts,
                                     const std::vector<rendering::PlannedCapture>& plan,
                                     absl::Duration duration) {
  if (plan.empty()) return absl::InvalidArgumentError("no scenes are planned; plan at least one");
  const absl::StatusOr<rendering::DepthCamera> camera =
      rendering::DepthCamera::Create(SimulatedKinectV1());
  if (!camera.ok()) return camera.status();
  absl::StatusOr<FakenectRecording> recording = FakenectRecording::Create(folder);
  if (!recording.ok()) return recording.status();
  for (const rendering::PlannedCapture& scene : plan) {
    if (absl::Status known = rendering::CheckPlacements(parts, scene); !known.ok()) return known;
    const absl::StatusOr<rendering::DepthFrame> frame = camera->Render(
        rendering::SceneOf(parts, scene, /*with_table=*/true), scene.world_sensor, scene.seed);
    if (!frame.ok()) return frame.status();
    if (absl::Status shown = recording->Show(*frame, duration); !shown.ok()) return shown;
  }
  if (absl::Status truth = rendering::WriteScenes(folder, parts, plan); !truth.ok()) return truth;
  return recording->Finish();
}

}  // namespace graspdb::client
