// Objects taught from their meshes and recognized in drop poses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/trials/part_set.h"

namespace graspdb::lab {

struct DropPoseSelection {
  // Smaller and larger meshes are left out, by their diameter.
  double min_length_m = 0.04;
  double max_length_m = 0.30;
  int falls = 24;  // of each mesh
  std::uint64_t seed = 1;
};

// The mesh files `paths` (one unit is `unit_scale_m` metres). The taught stable poses and
// symmetries are those that `graspdb teach --mesh` proposes. The queries show each mesh on a facet
// on which it comes to rest, drawn by its probability among all of them (RestingFacets), including
// rare ones and those that were grouped under another one; these are called "drop-1", "drop-2",
// … FAILED_PRECONDITION when no mesh is left; errors as LoadPartMesh and ProposeCadPart.
absl::StatusOr<PartSet> DropPoses(const std::vector<std::filesystem::path>& paths,
                                  double unit_scale_m, const DropPoseSelection& selection);

}  // namespace graspdb::lab
