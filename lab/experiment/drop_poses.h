// Objects that were taught from their meshes, and fell on the table as they do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/part_set.h"

namespace graspdb::client {

struct DropPoseSelection {
  // Smaller and larger meshes are left out, by their diameter.
  double min_length_m = 0.04;
  double max_length_m = 0.30;
  int falls = 24;  // of each mesh
  std::uint64_t seed = 1;
};

// The mesh files `paths` (one unit is `unit_scale_m` metres). Taught is what `graspdb teach --mesh`
// proposes: stable poses with the symmetries that it finds. Asked about is each mesh on a facet on
// which it comes to rest, drawn by its probability among all of them (RestingFacets), rare ones and
// those that were grouped under another one too; these are called "fallen-1", "fallen-2", …
// FAILED_PRECONDITION when no mesh is left; errors as LoadPartMesh and ProposeCadPart.
absl::StatusOr<PartSet> DropPoses(const std::vector<std::filesystem::path>& paths,
                                  double unit_scale_m, const DropPoseSelection& selection);

}  // namespace graspdb::client
