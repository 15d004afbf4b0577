#include "rendering/simulation.h"

#include <algorithm>
#include <system_error>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/capture_sets/capture_set.h"
#include "files/messages/pose_message.h"
#include "files/points/point_file.h"
#include "rendering/meshes/mesh_file.h"

namespace graspdb::rendering {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t kNamedSurface = 0;  // the first placement of a capture

absl::Status RemoveOldSet(const fs::path& folder, bool overwrite) {
  const fs::path description = folder / files::kCaptureSetFile;
  std::error_code error;
  if (!fs::exists(description, error)) return absl::OkStatus();
  if (!overwrite) {
    return absl::AlreadyExistsError(
        absl::StrCat(folder.string(),
                     " contains a capture set; choose another folder, or give --overwrite to "
                     "replace it"));
  }
  if (fs::remove(description, error)) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat("cannot replace ", description.string(), ": ", error.message()));
}

absl::Status CheckPlan(const std::vector<Workpiece>& parts,
                       const std::vector<PlannedCapture>& plan) {
  if (plan.empty()) return absl::InvalidArgumentError("no captures are planned");
  for (const PlannedCapture& capture : plan) {
    if (capture.placements.empty()) {
      return absl::InvalidArgumentError(capture.path + " is planned without a workpiece");
    }
    RETURN_IF_ERROR(CheckPlacements(parts, capture));
  }
  return absl::OkStatus();
}

void KeepNamedSurface(DepthFrame& frame) {
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i) {
    if (frame.surface[i] != kNamedSurface) frame.depth_m[i] = 0;
  }
}

absl::StatusOr<files::PointFile> Take(const DepthCamera& camera,
                                      const std::vector<Workpiece>& parts,
                                      const PlannedCapture& capture,
                                      const SimulationOptions& options) {
  ASSIGN_OR_RETURN(DepthFrame frame, camera.Render(SceneOf(parts, capture, options.with_table),
                                                   capture.world_sensor, capture.seed));
  if (std::find(frame.surface.begin(), frame.surface.end(), kNamedSurface) == frame.surface.end()) {
    return absl::FailedPreconditionError(absl::StrCat(
        "nothing of ", parts[capture.placements.front().part].object_id, " is visible in ",
        capture.path, "; the camera measures from ", camera.model().min_depth_m, " to ",
        camera.model().max_depth_m, " m, choose another distance"));
  }
  if (options.segmented) KeepNamedSurface(frame);
  return files::PointFile{.points = ToPoints(frame, camera.model().intrinsics),
                          .normals = {},
                          .width = frame.width,
                          .height = frame.height,
                          .sensor_pose = capture.world_sensor};
}

absl::Status WriteMeshes(const fs::path& folder, const std::vector<Workpiece>& parts) {
  for (const Workpiece& part : parts) {
    const fs::path path = folder / DeclarationOf(part).mesh_path();
    RETURN_IF_ERROR(WriteMeshPly(path, part.mesh));
  }
  return absl::OkStatus();
}

}  // namespace

v1::AxisAlignedBox SimulatedRegion() {
  v1::AxisAlignedBox region;
  region.mutable_min()->set_x(-kRegionHalfWidthM);
  region.mutable_min()->set_y(-kRegionHalfWidthM);
  region.mutable_min()->set_z(-0.02);
  region.mutable_max()->set_x(kRegionHalfWidthM);
  region.mutable_max()->set_y(kRegionHalfWidthM);
  region.mutable_max()->set_z(0.40);
  return region;
}

v1::CaptureSet DeclareParts(const std::vector<Workpiece>& parts) {
  v1::CaptureSet set;
  for (const Workpiece& part : parts) *set.add_objects() = DeclarationOf(part);
  *set.mutable_region_of_interest() = SimulatedRegion();
  return set;
}

v1::Capture CaptureOf(const std::vector<Workpiece>& parts, const PlannedCapture& planned,
                      const Placement& placement) {
  v1::Capture capture;
  capture.set_path(planned.path);
  capture.set_split(planned.split);
  capture.set_object_id(parts[placement.part].object_id);
  capture.set_stable_pose_id(parts[placement.part].stable_pose_id);
  *capture.mutable_object_pose() = files::ToMessage(placement.world_object);
  *capture.mutable_sensor_pose() = files::ToMessage(planned.world_sensor);
  return capture;
}

Scene SceneOf(const std::vector<Workpiece>& parts, const PlannedCapture& capture, bool with_table) {
  Scene scene;
  scene.with_table = with_table;
  for (const Placement& p : capture.placements) {
    scene.objects.push_back({.mesh = &parts[p.part].mesh, .world_object = p.world_object});
  }
  return scene;
}

absl::Status WriteSimulation(const fs::path& folder, const std::vector<Workpiece>& parts,
                             const std::vector<PlannedCapture>& plan,
                             const SimulationOptions& options, const SimulationWatch& watch) {
  RETURN_IF_ERROR(CheckPlan(parts, plan));
  ASSIGN_OR_RETURN(DepthCamera camera, DepthCamera::Create(options.camera));
  RETURN_IF_ERROR(RemoveOldSet(folder, options.overwrite));
  RETURN_IF_ERROR(WriteMeshes(folder, parts));
  v1::CaptureSet set = DeclareParts(parts);
  for (std::size_t i = 0; i < plan.size(); ++i) {
    if (watch.cancelled && watch.cancelled()) {
      return absl::CancelledError(absl::StrCat("stopped after ", i, " of ", plan.size(),
                                               " captures; run it again to complete the set"));
    }
    ASSIGN_OR_RETURN(files::PointFile cloud, Take(camera, parts, plan[i], options));
    RETURN_IF_ERROR(files::WritePcd(folder / plan[i].path, cloud));
    v1::Capture& capture = *set.add_captures();
    capture = CaptureOf(parts, plan[i], plan[i].placements.front());
    capture.set_segmented(options.segmented);
    if (watch.report) watch.report(static_cast<int>(i) + 1, static_cast<int>(plan.size()));
  }
  return files::SaveCaptureSet(folder, set);
}

}  // namespace graspdb::rendering
