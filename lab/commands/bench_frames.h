// Requests of `bench`.
#pragma once

#include <CLI/CLI.hpp>
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

// Options of the frames.
struct BenchFrames {
  std::vector<std::string> inputs;
  std::string split = "ALL";
  bool simulate = false;
  std::string camera = "v2";
  SimulatedFrames simulated;
  int limit = 0;  // the first scans only; 0: all
  std::string cell;
  bool segmented = false;
  v1::PipelineParameters pipeline;
};

// Adds SCAN… and the flags of frames.
void AddFrameOptions(CLI::App& command, BenchFrames* frames);

// The requests, all of them in memory. Errors as ListScans, ReadScan and SimulateRequests;
// CANCELLED on Ctrl-C.
absl::StatusOr<std::vector<v1::RecognizeRequest>> MakeRequests(const BenchFrames& frames);

// "16 depth images of 512 x 424, 0.43 MB each".
std::string DescribeRequests(const std::vector<v1::RecognizeRequest>& requests);

}  // namespace graspdb::lab
