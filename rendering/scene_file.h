// A simulated scene in a file: writing it moves the objects before the simulated camera.
#pragma once

#include <filesystem>
#include <vector>

#include "absl/status/statusor.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::rendering {

// Writes the placements and the camera pose as a capture set without clouds, one capture for each
// object, whose path is that of the scene with the object's number. Atomic: a reader gets the old
// or the new scene. INVALID_ARGUMENT when a scene has a workpiece that is not in `parts`; errors of
// SaveCaptureSet.
absl::Status WriteScenes(const std::filesystem::path& folder, const std::vector<Workpiece>& parts,
                         const std::vector<PlannedCapture>& scenes);

// Reads the scene of a folder. Objects are looked up in `parts` by object and stable pose; the seed
// of the noise is a hash of the content. UNAVAILABLE when there is no such folder, like a camera
// that is not plugged in; INVALID_ARGUMENT when it is no scene or more than one, or has objects
// that are not in `parts`.
absl::StatusOr<PlannedCapture> ReadScene(const std::filesystem::path& folder,
                                         const std::vector<Workpiece>& parts);

}  // namespace graspdb::rendering
