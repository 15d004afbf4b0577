// Workpieces from meshes, in the attitudes in which they rest.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/sensors/workpiece.h"

namespace graspdb::client {

// Which meshes and attitudes an experiment takes.
struct MeshSelection {
  int attitudes = 1;              // at most, the most probable first
  double min_probability = 0.08;  // of an attitude, see RestingPose
  double min_length_m = 0;        // diameter of the mesh
  double max_length_m = 1;
};

// The mesh files `paths` (one unit is `unit_scale_m` metres) as workpieces on the table: the
// object is named after the file, the stable poses "resting-1", "resting-2", … Meshes outside of
// the selection are left out. Errors as LoadMesh and RestingPoses.
absl::StatusOr<std::vector<Workpiece>> RestingParts(const std::vector<std::filesystem::path>& paths,
                                                    double unit_scale_m,
                                                    const MeshSelection& selection);

}  // namespace graspdb::client
