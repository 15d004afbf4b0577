#include "client/cli/teach/stable_pose_table.h"

#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace graspdb::client {
namespace {

std::string SymmetryText(const recognition::FoundSymmetry& found) {
  if (found.order == 1) return "none";
  const std::string order = found.order == 0 ? "any turn" : absl::StrFormat("%d-fold", found.order);
  return found.nearly ? absl::StrCat("none (nearly ", order, ")") : order;
}

std::string GraspText(const rendering::Workpiece& part) {
  if (part.grasps.empty()) return "none: nothing fits between the fingers from above";
  return absl::StrJoin(part.grasps, ", ", [](std::string* out, const v1::Grasp& grasp) {
    absl::StrAppend(out, absl::StrFormat("%s (opens %.0f mm)", grasp.grasp_id(),
                                         1e3 * grasp.gripper_opening_m()));
  });
}

}  // namespace

std::string StablePoseTable(const CadPart& part) {
  std::string out =
      "stable pose   likely %  tips at deg  looks the same      size mm        grasps\n";
  for (std::size_t i = 0; i < part.workpieces.size(); ++i) {
    const MeshStablePose& pose = part.found.poses[i];
    const recognition::Box box = rendering::BoundsOf(part.workpieces[i].mesh);
    const Eigen::Vector3d size = 1e3 * (box.max - box.min);
    absl::StrAppend(
        &out, absl::StrFormat(
                  "%-12s  %8.1f  %11.1f  %-18s  %-13s  %s\n", part.workpieces[i].stable_pose_id,
                  100 * pose.probability, pose.tip_angle_rad * 180 / std::numbers::pi,
                  absl::StrCat(SymmetryText(pose.symmetry), pose.rolls ? ", rolls" : ""),
                  absl::StrFormat("%.0fx%.0fx%.0f", size.x(), size.y(), size.z()),
                  GraspText(part.workpieces[i])));
  }
  if (part.found.left_out > 0.0005) {
    absl::StrAppend(&out, absl::StrFormat("left out      %8.1f  see --min-probability\n",
                                          100 * part.found.left_out));
  }
  if (part.found.mass.of_hull) {
    absl::StrAppend(&out,
                    "note: the surface is not closed; the centre of mass is that of its convex "
                    "hull\n");
  }
  return out;
}

}  // namespace graspdb::client
