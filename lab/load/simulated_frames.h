// Frames for a load test that has no files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "rendering/camera/depth_camera.h"

namespace graspdb::lab {

struct SimulatedFrames {
  std::vector<std::string> parts;  // ids of sample parts; none: all
  rendering::DepthCameraModel camera = rendering::KinectV2();
  int count = 16;
  int objects_per_scene = 1;
  std::uint64_t seed = 1;
};

// Requests with frames of a simulated camera on random scenes, as a robot's program sends them:
// depth images in whole millimetres, with the camera's intrinsics and pose and the region of
// interest. Errors as PlanRandomScenes and DepthCamera.
absl::StatusOr<std::vector<v1::RecognizeRequest>> SimulateRequests(const SimulatedFrames& frames);

}  // namespace graspdb::lab
