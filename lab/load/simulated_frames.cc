#include "lab/load/simulated_frames.h"

#include "files/depth_message.h"
#include "files/pose_message.h"
#include "rendering/sample_parts.h"
#include "rendering/simulation.h"

namespace graspdb::client {
namespace {

constexpr double kDepthUnitM = 0.001;

}  // namespace

absl::StatusOr<std::vector<v1::RecognizeRequest>> SimulateRequests(const SimulatedFrames& frames) {
  const absl::StatusOr<std::vector<Workpiece>> parts = SampleParts(frames.parts);
  if (!parts.ok()) return parts.status();
  RandomSceneOptions scenes;
  scenes.count = frames.count;
  scenes.objects_per_scene = frames.objects_per_scene;
  scenes.seed = frames.seed;
  absl::StatusOr<std::vector<PlannedCapture>> plan = PlanRandomScenes(*parts, scenes);
  if (!plan.ok()) return plan.status();
  absl::StatusOr<DepthCamera> camera = DepthCamera::Create(frames.camera);
  if (!camera.ok()) return camera.status();
  std::vector<v1::RecognizeRequest> out;
  for (const PlannedCapture& capture : *plan) {
    absl::StatusOr<DepthFrame> frame = camera->Render(SceneOf(*parts, capture, /*with_table=*/true),
                                                      capture.world_sensor, capture.seed);
    if (!frame.ok()) return frame.status();
    v1::RecognizeRequest& request = out.emplace_back();
    *request.mutable_depth_image() =
        files::DepthMessage(ToCounts(*frame, kDepthUnitM), frames.camera.intrinsics, kDepthUnitM);
    *request.mutable_sensor_pose() = files::ToMessage(capture.world_sensor);
    *request.mutable_region_of_interest() = SimulatedRegion();
  }
  return out;
}

}  // namespace graspdb::client
