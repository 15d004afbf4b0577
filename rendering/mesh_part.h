// Workpieces from mesh files.
#pragma once

#include <filesystem>
#include <string>

#include "absl/status/statusor.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// As LoadMesh; INVALID_ARGUMENT too when the largest side is not between 5 mm and 0.6 m, as a wrong
// unit makes it, with the units that would fit.
absl::StatusOr<TriangleMesh> LoadPartMesh(const std::filesystem::path& path, double unit_scale_m);

// The id of an object that is named after a file: in lower case, with '-' for what an id may not
// hold.
std::string ObjectIdOf(const std::filesystem::path& path);

// The mesh at `path` (one unit is `unit_scale_m` metres) as it lies: its lowest
// point is put on z = 0 and the middle of its bounding box on the z axis; it is
// not turned. The id is ObjectIdOf the path; the stable pose is "resting", without symmetry, with
// one top grasp across the narrower side of the bounding box.
//
// Errors as LoadPartMesh.
absl::StatusOr<Workpiece> WorkpieceFromMesh(const std::filesystem::path& path,
                                            double unit_scale_m = 1);

}  // namespace graspdb::client
