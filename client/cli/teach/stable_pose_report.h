// The stable poses of a mesh as a table and in pictures, to choose which ones to teach.
#pragma once

#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "client/teaching/mesh/cad_part.h"

namespace graspdb::client {

// A line for every stable pose: its number and name, probability, tip angle, symmetry, size and
// grasps; and the probability of the omitted ones. Ends with a line end.
std::string StablePoseTable(const CadPart& part);

// Writes OBJECT-POSE.png for every stable pose into `folder`, which is created if it is missing:
// seen from 35 degrees above, near enough to fill the picture. FAILED_PRECONDITION when it cannot
// be written; errors of RayCaster.
absl::Status WriteStablePosePictures(const CadPart& part, const std::filesystem::path& folder);

}  // namespace graspdb::client
