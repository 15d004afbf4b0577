// A picture of every stable pose of a mesh.
#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "client/teaching/mesh/cad_part.h"

namespace graspdb::client {

// Writes OBJECT-POSE.png for every stable pose into `folder`, which is created if it is missing:
// seen from 35 degrees above, near enough to fill the picture. FAILED_PRECONDITION when it cannot
// be written; errors of RayCaster.
absl::Status WriteStablePosePictures(const CadPart& part, const std::filesystem::path& folder);

}  // namespace graspdb::client
