// Workpieces from mesh files.
#pragma once

#include <filesystem>
#include <string>

#include "absl/status/statusor.h"
#include "rendering/workpiece.h"

namespace graspdb::rendering {

// As LoadMesh; also INVALID_ARGUMENT, with the units that would fit, when the largest side is not
// between 5 mm and 0.6 m, usually because of a wrong unit.
absl::StatusOr<TriangleMesh> LoadPartMesh(const std::filesystem::path& path, double unit_scale_m);

// As LoadMesh, of a file in metres, such as the meshes of a capture set; also INVALID_ARGUMENT when
// the largest side is not between 1 mm and 5 m. A wrong unit would scale the limits of pose errors
// with it, so that every pose would be right.
absl::StatusOr<TriangleMesh> LoadMeshInMetres(const std::filesystem::path& path);

// The id of an object that is named after a file: in lower case, with '-' for invalid characters.
std::string ObjectIdOf(const std::filesystem::path& path);

// The mesh at `path` (one unit is `unit_scale_m` metres) in its own orientation: its lowest point
// is put on z = 0 and the middle of its bounding box on the z axis. The id is ObjectIdOf the path;
// the stable pose is "resting", without symmetry, with one top grasp across the narrower side of
// the bounding box.
//
// Errors as LoadPartMesh.
absl::StatusOr<Workpiece> WorkpieceFromMesh(const std::filesystem::path& path,
                                            double unit_scale_m = 1);

}  // namespace graspdb::rendering
