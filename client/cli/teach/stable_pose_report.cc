#include "client/cli/teach/stable_pose_report.h"

#include <cmath>
#include <numbers>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status_macros.h"
#include "pictures/shaded_picture.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/camera/ray_caster.h"

namespace graspdb::client {
namespace {

constexpr recognition::CameraIntrinsics kCamera = {
    .width = 480, .height = 360, .fx = 600, .fy = 600, .cx = 239.5, .cy = 179.5};
constexpr double kLookDownDeg = 35;
constexpr double kAzimuthDeg = -60;
constexpr double kDiametersAway = 2.2;
constexpr std::uint8_t kTable = 60;
constexpr std::uint8_t kNothing = 20;

std::uint8_t Brightness(std::int32_t surface, float incidence_rad) {
  if (surface == rendering::kTableSurface) return kTable;
  if (surface < 0) return kNothing;
  return static_cast<std::uint8_t>(90 +
                                   std::lround(160 * std::cos(static_cast<double>(incidence_rad))));
}

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

absl::Status WriteStablePosePictures(const CadPart& part, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return absl::FailedPreconditionError(absl::StrCat("cannot make ", folder.string(), ": ",
                                                      error.message(), "; choose another folder"));
  }
  ASSIGN_OR_RETURN(const rendering::RayCaster rays, rendering::RayCaster::Create());
  for (std::size_t i = 0; i < part.workpieces.size(); ++i) {
    const rendering::Workpiece& workpiece = part.workpieces[i];
    rendering::Scene scene;
    scene.objects.push_back(
        {.mesh = &workpiece.mesh, .world_object = recognition::Pose::Identity()});
    const recognition::Box box = rendering::BoundsOf(workpiece.mesh);
    const Eigen::Vector3d middle(0, 0, box.max.z() / 2);
    ASSIGN_OR_RETURN(
        const auto frame,
        rays.Cast(scene, kCamera,
                  rendering::LookAt(middle, kDiametersAway * rendering::DiameterOf(workpiece.mesh),
                                    kLookDownDeg, kAzimuthDeg)));
    pictures::ShadedPicture picture{
        .caption = absl::StrFormat("%s %s: %.1f %%", workpiece.object_id, workpiece.stable_pose_id,
                                   100 * part.found.poses[i].probability),
        .width = frame.width,
        .height = frame.height,
        .brightness = {}};
    picture.brightness.reserve(frame.surface.size());
    for (std::size_t k = 0; k < frame.surface.size(); ++k) {
      picture.brightness.push_back(Brightness(frame.surface[k], frame.incidence_rad[k]));
    }
    const std::string name =
        absl::StrCat(workpiece.object_id, "-", workpiece.stable_pose_id, ".png");
    RETURN_IF_ERROR(pictures::WriteShadedPicture(folder / name, picture));
  }
  return absl::OkStatus();
}

}  // namespace graspdb::client
