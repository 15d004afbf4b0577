#include "client/teaching/mesh/cad_part.h"

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::client {

absl::StatusOr<CadPart> ProposeCadPart(const std::string& object_id,
                                       const std::string& display_name,
                                       const rendering::TriangleMesh& mesh,
                                       const CadOptions& options) {
  ASSIGN_OR_RETURN(MeshStablePoses found, FindStablePoses(mesh, options.poses));
  CadPart out{.workpieces = {}, .found = std::move(found)};
  for (const MeshStablePose& pose : out.found.poses) {
    rendering::Workpiece part{.object_id = object_id,
                              .display_name = display_name,
                              .stable_pose_id = absl::StrCat("resting-", out.workpieces.size() + 1),
                              .symmetry_order = pose.symmetry_order(),
                              .grasps = {},
                              .mesh = rendering::Transformed(mesh, pose.object_mesh),
                              .object_mesh = pose.object_mesh};
    part.grasps = ProposeTopGrasps({.mesh = &part.mesh,
                                    .mass_center = pose.object_mesh * out.found.mass.center,
                                    .any_turn = part.symmetry_order == 0},
                                   options.gripper);
    out.workpieces.push_back(std::move(part));
  }
  return out;
}

absl::StatusOr<CadPart> Select(const CadPart& part, const std::vector<int>& numbers) {
  CadPart out{.workpieces = {}, .found = {.poses = {}, .left_out = 0, .mass = part.found.mass}};
  for (const int number : numbers) {
    if (number < 1 || number > static_cast<int>(part.workpieces.size())) {
      return absl::InvalidArgumentError(absl::StrCat("there is no stable pose ", number,
                                                     "; choose among 1 to ", part.workpieces.size(),
                                                     ", as --dry-run lists them"));
    }
    const auto at = static_cast<std::size_t>(number - 1);
    const std::string& id = part.workpieces[at].stable_pose_id;
    if (std::ranges::find(out.workpieces, id, &rendering::Workpiece::stable_pose_id) !=
        out.workpieces.end()) {
      continue;
    }
    out.workpieces.push_back(part.workpieces[at]);
    out.found.poses.push_back(part.found.poses[at]);
  }
  return out;
}

}  // namespace graspdb::client
