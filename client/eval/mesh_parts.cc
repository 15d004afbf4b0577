#include "client/eval/mesh_parts.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/eval/resting_pose.h"
#include "client/sensors/mesh_file.h"
#include "client/sensors/mesh_part.h"

namespace graspdb::client {

absl::StatusOr<std::vector<Workpiece>> RestingParts(const std::vector<std::filesystem::path>& paths,
                                                    double unit_scale_m,
                                                    const MeshSelection& selection) {
  std::vector<Workpiece> out;
  for (const std::filesystem::path& path : paths) {
    const absl::StatusOr<Workpiece> as_it_lies = WorkpieceFromMesh(path, unit_scale_m);
    if (!as_it_lies.ok()) return as_it_lies.status();
    const double length = DiameterOf(as_it_lies->mesh);
    if (length < selection.min_length_m || length > selection.max_length_m) continue;
    auto attitudes = RestingPoses(as_it_lies->mesh, selection.min_probability);
    if (!attitudes.ok()) return attitudes.status();
    const auto count = std::min(attitudes->size(), static_cast<std::size_t>(selection.attitudes));
    for (std::size_t i = 0; i < count; ++i) {
      Workpiece part = *as_it_lies;
      part.stable_pose_id = absl::StrCat("resting-", i + 1);
      part.mesh = Transformed(as_it_lies->mesh, (*attitudes)[i].table_mesh);
      part.grasps.clear();
      out.push_back(std::move(part));
    }
  }
  return out;
}

}  // namespace graspdb::client
