// Simulated scenes as a recording of a Kinect v1.
#pragma once

#include <filesystem>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// Writes a recording that fakenect plays (see fakenect_recording.h): each scene of `plan` as
// SimulatedKinectV1 sees it, standing still for `hold`, and what is where (see scene_file.h). One
// image a scene is kept; the noise is the same as long as it stands.
//
// Errors as FakenectRecording and DepthCamera::Render; INVALID_ARGUMENT for a scene with a
// workpiece that `parts` has not, or without scenes.
absl::Status WriteSimulatedRecording(const std::filesystem::path& folder,
                                     const std::vector<Workpiece>& parts,
                                     const std::vector<PlannedCapture>& plan, absl::Duration hold);

}  // namespace graspdb::client
