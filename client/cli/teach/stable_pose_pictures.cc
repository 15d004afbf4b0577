#include "client/cli/teach/stable_pose_pictures.h"

#include <cmath>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
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

}  // namespace

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
