// A simulated scene in a file: whoever writes it moves objects about before the simulated camera.
#pragma once

#include <filesystem>
#include <vector>

#include "absl/status/statusor.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// Writes what is placed and where the camera stands as a capture set without clouds, one capture
// for each object, whose path is the scene's and its number in it; at once: a reader sees what was
// there before or all of the new. INVALID_ARGUMENT when a scene has a workpiece that `parts` has
// not; errors of SaveCaptureSet.
absl::Status WriteScenes(const std::filesystem::path& folder, const std::vector<Workpiece>& parts,
                         const std::vector<PlannedCapture>& scenes);

// Reads the scene of a folder that holds one. Objects are found among `parts` by object and stable
// pose; the noise follows from the content. UNAVAILABLE when there is no such folder, as a camera
// that is not plugged in; INVALID_ARGUMENT when it is no scene or more than one, or has objects
// that are not among `parts`.
absl::StatusOr<PlannedCapture> ReadScene(const std::filesystem::path& folder,
                                         const std::vector<Workpiece>& parts);

}  // namespace graspdb::client
