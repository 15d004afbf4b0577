// Mesh files as assimp reads them right.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "absl/status/statusor.h"

namespace graspdb::rendering {

struct MeshContent {
  std::string bytes;
  std::string format;            // "ply", "obj" or "stl", assimp's names
  std::optional<double> unit_m;  // that a comment or header states in `unit_line`
  std::string unit_line;
};

// The content of a PLY, OBJ or STL file, whatever the case of its extension. Other formats have
// axes and units that would turn and scale the mesh.
//
// INVALID_ARGUMENT, without the path: another format, bytes or numbers that the format does not
// account for, or PLY faces that are not lists of corners, such as triangle strips.
absl::StatusOr<MeshContent> ReadMeshContent(const std::filesystem::path& path);

}  // namespace graspdb::rendering
