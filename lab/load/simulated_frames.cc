#include "lab/load/simulated_frames.h"

#include "base/status_macros.h"
#include "files/messages/depth_message.h"
#include "files/messages/pose_message.h"
#include "rendering/sample_parts.h"
#include "rendering/simulation.h"

namespace graspdb::lab {
namespace {

constexpr double kDepthUnitM = 0.001;

}  // namespace

absl::StatusOr<std::vector<v1::RecognizeRequest>> SimulateRequests(const SimulatedFrames& frames) {
  ASSIGN_OR_RETURN(const std::vector<rendering::Workpiece> parts,
                   rendering::SampleParts(frames.parts));
  rendering::RandomSceneOptions scenes;
  scenes.count = frames.count;
  scenes.objects_per_scene = frames.objects_per_scene;
  scenes.seed = frames.seed;
  ASSIGN_OR_RETURN(std::vector<rendering::PlannedCapture> plan,
                   rendering::PlanRandomScenes(parts, scenes));
  ASSIGN_OR_RETURN(rendering::DepthCamera camera, rendering::DepthCamera::Create(frames.camera));
  std::vector<v1::RecognizeRequest> out;
  for (const rendering::PlannedCapture& capture : plan) {
    ASSIGN_OR_RETURN(rendering::DepthFrame frame,
                     camera.Render(rendering::SceneOf(parts, capture, /*with_table=*/true),
                                   capture.world_sensor, capture.seed));
    v1::RecognizeRequest& request = out.emplace_back();
    *request.mutable_depth_image() = files::DepthMessage(rendering::ToCounts(frame, kDepthUnitM),
                                                         frames.camera.intrinsics, kDepthUnitM);
    *request.mutable_sensor_pose() = files::ToMessage(capture.world_sensor);
    *request.mutable_region_of_interest() = rendering::SimulatedRegion();
  }
  return out;
}

}  // namespace graspdb::lab
