#include "client/cell/sensors/kinect/simulated_recording.h"

#include "base/status_macros.h"
#include "client/cell/sensors/kinect/fakenect_recording.h"
#include "client/cell/sensors/kinect/kinect_v1_calibration.h"
#include "rendering/scene_file.h"
#include "rendering/simulation.h"

namespace graspdb::client {

absl::Status WriteSimulatedRecording(const std::filesystem::path& folder,
                                     const std::vector<rendering::Workpiece>& parts,
                                     const std::vector<rendering::PlannedCapture>& plan,
                                     absl::Duration duration) {
  if (plan.empty()) return absl::InvalidArgumentError("no scenes are planned; plan at least one");
  ASSIGN_OR_RETURN(const rendering::DepthCamera camera,
                   rendering::DepthCamera::Create(SimulatedKinectV1()));
  ASSIGN_OR_RETURN(FakenectRecording recording, FakenectRecording::Create(folder));
  for (const rendering::PlannedCapture& scene : plan) {
    RETURN_IF_ERROR(rendering::CheckPlacements(parts, scene));
    ASSIGN_OR_RETURN(const rendering::DepthFrame frame,
                     camera.Render(rendering::SceneOf(parts, scene, /*with_table=*/true),
                                   scene.world_sensor, scene.seed));
    RETURN_IF_ERROR(recording.Show(frame, duration));
  }
  RETURN_IF_ERROR(rendering::WriteScenes(folder, parts, plan));
  return recording.Finish();
}

}  // namespace graspdb::client
