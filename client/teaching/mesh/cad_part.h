// A mesh as what is to be taught of it.
#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/teaching/mesh/stable_poses.h"
#include "client/teaching/mesh/top_grasps.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

struct CadOptions {
  // One in a hundred drops; 5 degrees, several times what a table is out of level. With 10 degrees
  // slender bottles are left out (6 degrees), with 2.5 objects that a knock tips over are taught.
  StablePoseChoice poses{.min_probability = 0.01, .stands_rad = 5 * std::numbers::pi / 180};
  ParallelGripper gripper;
};

// A mesh with its stable poses. Position by position the same: `workpieces` are one object, whose
// stable poses are called "resting-1", "resting-2", … by falling probability.
struct CadPart {
  std::vector<Workpiece> workpieces;
  MeshStablePoses found;
};

// Stable poses, their symmetries and grasps for `mesh` (metres). Deterministic. Errors as
// FindStablePoses.
absl::StatusOr<CadPart> ProposeCadPart(const std::string& object_id,
                                       const std::string& display_name, const TriangleMesh& mesh,
                                       const CadOptions& options);

// Only the stable poses with these numbers, 1 for the most probable one. INVALID_ARGUMENT for a
// number that there is not.
absl::StatusOr<CadPart> Select(const CadPart& part, const std::vector<int>& numbers);

}  // namespace graspdb::client
