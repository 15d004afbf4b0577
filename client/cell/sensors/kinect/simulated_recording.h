// Records simulated scenes as a Kinect v1 would.
#pragma once

#include <filesystem>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// Writes a recording for fakenect (see fakenect_recording.h): each scene of `plan` as rendered by
// SimulatedKinectV1, repeated for `duration`, and the ground truth (see scene_file.h). One image is
// stored per scene, so its noise does not change during `duration`.
//
// Errors as FakenectRecording and DepthCamera::Render; INVALID_ARGUMENT for a scene with a
// workpiece that is not in `parts`, or without scenes.
absl::Status WriteSimulatedRecording(const std::filesystem::path& folder,
                                     const std::vector<rendering::Workpiece>& parts,
                                     const std::vector<rendering::PlannedCapture>& plan,
                                     absl::Duration duration);

}  // namespace graspdb::client
