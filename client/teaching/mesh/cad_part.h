// A mesh as stable poses and grasps to teach.
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
  // One in a hundred drops; 5 degrees, several times the tilt of a table. With 10 degrees slender
  // bottles are omitted (6 degrees), with 2.5 objects that a knock tips over are taught.
  StablePoseChoice poses{.min_probability = 0.01, .stands_rad = 5 * std::numbers::pi / 180};
  ParallelGripper gripper;
};

// A mesh with its stable poses, in the same order in both members. `workpieces` are one object,
// whose stable poses are named "resting-1", "resting-2", … by falling probability.
struct CadPart {
  std::vector<rendering::Workpiece> workpieces;
  MeshStablePoses found;
};

// The stable poses of `mesh` (metres) with symmetries and grasps. Deterministic. Errors as
// FindStablePoses.
absl::StatusOr<CadPart> ProposeCadPart(const std::string& object_id,
                                       const std::string& display_name,
                                       const rendering::TriangleMesh& mesh,
                                       const CadOptions& options);

// Only the stable poses with these numbers, each once, 1 for the most probable one.
// INVALID_ARGUMENT for a number that does not exist.
absl::StatusOr<CadPart> Select(const CadPart& part, const std::vector<int>& numbers);

}  // namespace graspdb::client
