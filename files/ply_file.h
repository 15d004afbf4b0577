// Clouds in PLY files.
#pragma once

#include <filesystem>

#include "absl/status/statusor.h"
#include "files/point_file.h"

namespace graspdb::client {

// Reads the vertices of a PLY file, see ReadPointFile; faces and other elements
// are passed over. Written here and not left to PCL, whose PLY reader crashes on
// well-formed meshes and on damaged headers.
//
// INVALID_ARGUMENT with the path, what is wrong and what to do.
absl::StatusOr<PointFile> ReadPly(const std::filesystem::path& path);

}  // namespace graspdb::client
