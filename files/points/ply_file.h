// Clouds in PLY files.
#pragma once

#include <filesystem>

#include "absl/status/statusor.h"
#include "files/points/point_file.h"

namespace graspdb::files {

// Reads the vertices of a PLY file, see ReadPointFile; faces and other elements
// are ignored. PCL's PLY reader is not used, as it crashes on well-formed meshes
// and on damaged headers.
//
// INVALID_ARGUMENT with the path, the error and advice.
absl::StatusOr<PointFile> ReadPly(const std::filesystem::path& path);

}  // namespace graspdb::files
