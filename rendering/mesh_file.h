// Meshes in files.
#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "rendering/mesh.h"

namespace graspdb::client {

// Reads a mesh that assimp knows (PLY, OBJ, STL and more). All meshes of the file are merged, with
// the transforms of its nodes; polygons are split into triangles and equal vertices joined;
// the triangles of a closed surface that all turn inwards, as of mirrored parts, are turned
// outwards. `unit_scale_m` is the length of one unit of the file in metres: 1, or 0.001 for
// millimetres. Thread-safe.
//
// NOT_FOUND without such a file; INVALID_ARGUMENT with the path when it is no
// mesh, has no triangles or a vertex that is not finite, or the scale is not
// positive.
absl::StatusOr<TriangleMesh> LoadMesh(const std::filesystem::path& path, double unit_scale_m = 1);

// Writes a binary little-endian PLY file atomically. The same mesh gives the same bytes.
// INVALID_ARGUMENT from CheckMesh, otherwise the errors of WriteFileAtomically.
absl::Status WriteMeshPly(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace graspdb::client
