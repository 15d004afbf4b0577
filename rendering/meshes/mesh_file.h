// Meshes in files.
#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::rendering {

// Reads a PLY, OBJ or STL mesh. All meshes of the file are merged; polygons are split into
// triangles, equal vertices joined, and vertices of no face and repeated triangles left out; closed
// surfaces are turned outwards (TurnOutwards), such as those of mirrored parts. `unit_scale_m` is
// the length of one unit of the file in metres: 1, or 0.001 for millimetres. Thread-safe.
//
// NOT_FOUND without such a file; INVALID_ARGUMENT with the path when it is no mesh of these
// formats (see ReadMeshContent), has no triangles or a vertex that is not finite, or is so far from
// its origin that single precision changes its shape; when a comment states another unit; or when
// the scale is not positive.
absl::StatusOr<TriangleMesh> LoadMesh(const std::filesystem::path& path, double unit_scale_m = 1);

// Writes a binary little-endian PLY file atomically. The same mesh gives the same bytes.
// INVALID_ARGUMENT from CheckMesh, otherwise the errors of WriteFileAtomically.
absl::Status WriteMeshPly(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace graspdb::rendering
