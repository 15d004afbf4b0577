#include "client/teaching/upload/cad_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "rendering/random/counter_random.h"
#include "rendering/simulation.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::Pose;

constexpr std::uint64_t kSeed = 1;
// A camera whose axis falls by less than this per metre does not look at the table.
constexpr double kMinFall = 0.05;
constexpr int kMinSeenPixels = 30;
// Around the turning object: for noise and flying pixels.
constexpr double kRegionMarginM = 0.05;

bool IsWithin(const v1::AxisAlignedBox& box, const Vector3d& p) {
  return p.x() >= box.min().x() && p.x() <= box.max().x() && p.y() >= box.min().y() &&
         p.y() <= box.max().y();
}

// The region that the mesh sweeps when it turns about z.
v1::AxisAlignedBox RegionOf(const rendering::TriangleMesh& mesh) {
  double radius = 0;
  double height = 0;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    radius = std::max(radius, static_cast<double>(v.head<2>().norm()));
    height = std::max(height, static_cast<double>(v.z()));
  }
  v1::AxisAlignedBox region = rendering::SimulatedRegion();
  const double half_width = std::max(region.max().x(), radius + kRegionMarginM);
  region.mutable_min()->set_x(-half_width);
  region.mutable_min()->set_y(-half_width);
  region.mutable_max()->set_x(half_width);
  region.mutable_max()->set_y(half_width);
  region.mutable_max()->set_z(std::max(region.max().z(), height + kRegionMarginM));
  return region;
}

// Depth of the farthest corner, m.
double FarthestDepth(const v1::AxisAlignedBox& region, const Pose& world_sensor) {
  const Vector3d axis = world_sensor.linear().col(2);
  const Vector3d corner(axis.x() > 0 ? region.max().x() : region.min().x(),
                        axis.y() > 0 ? region.max().y() : region.min().y(),
                        axis.z() > 0 ? region.max().z() : region.min().z());
  return axis.dot(corner - world_sensor.translation());
}

// Renders views by their number: one stable pose after the other.
class Turntable {
 public:
  static absl::StatusOr<Turntable> Create(const std::vector<rendering::Workpiece>& parts,
                                          const CadViews& views) {
    ASSIGN_OR_RETURN(auto camera, rendering::DepthCamera::Create(views.camera));
    return Turntable(parts, views, std::move(camera));
  }

  std::size_t steps() const { return static_cast<std::size_t>(StepsOf(views_.step_deg)); }
  std::size_t count() const { return parts_.size() * steps(); }

  absl::Status Make(std::size_t number, v1::UploadViewsRequest* request) const {
    const rendering::Workpiece& part = parts_[number / steps()];
    const double azimuth_deg = static_cast<double>(number % steps()) * views_.step_deg;
    Pose world_object = Pose::Identity();
    world_object.rotate(Eigen::AngleAxisd(azimuth_deg * std::numbers::pi / 180, Vector3d::UnitZ()));
    rendering::Scene scene;
    scene.objects.push_back({.mesh = &part.mesh, .world_object = world_object});
    const auto azimuth = static_cast<std::uint64_t>(std::llround(azimuth_deg * 1000));
    ASSIGN_OR_RETURN(const auto frame,
                     camera_.Render(scene, views_.world_sensor,
                                    rendering::RandomBits(kSeed, Hash(part), azimuth)));
    if (std::ranges::count(frame.surface, 0) < kMinSeenPixels) return NotVisible(part);
    request->set_parent(StablePoseName(part.object_id, part.stable_pose_id));
    *request->mutable_region_of_interest() = RegionOf(part.mesh);
    v1::View* view = request->mutable_view();
    *view->mutable_depth_image() =
        files::FineDepthMessage(frame.depth_m, views_.camera.intrinsics,
                                FarthestDepth(request->region_of_interest(), views_.world_sensor));
    *view->mutable_object_pose() = files::ToMessage(world_object);
    *view->mutable_sensor_pose() = files::ToMessage(views_.world_sensor);
    return absl::OkStatus();
  }

 private:
  Turntable(const std::vector<rendering::Workpiece>& parts, const CadViews& views,
            rendering::DepthCamera camera)
      : parts_(parts), views_(views), camera_(std::move(camera)) {}

  // Stable poses have noise of their own (FNV-1a of their names).
  static std::uint64_t Hash(const rendering::Workpiece& part) {
    std::uint64_t hash = 14695981039346656037ULL;
    for (const char c : part.object_id + "/" + part.stable_pose_id) {
      hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
    }
    return hash;
  }

  absl::Status NotVisible(const rendering::Workpiece& part) const {
    return absl::FailedPreconditionError(absl::StrCat(
        "no part of ", part.object_id, " is visible in ", part.stable_pose_id,
        "; the camera measures from ", views_.camera.min_depth_m, " to ", views_.camera.max_depth_m,
        " m, choose another --distance or check the cell's pose"));
  }

  const std::vector<rendering::Workpiece>& parts_;
  const CadViews& views_;
  rendering::DepthCamera camera_;
};

// The same mesh gives the same frame; the tolerances allow for rounding by other compilers.
bool IsSameFrame(const Pose& a, const Pose& b) {
  constexpr double kSameFrameM = 1e-3;
  constexpr double kSameFrameRad = std::numbers::pi / 180;
  const Pose between = a.inverse() * b;
  return between.translation().norm() < kSameFrameM &&
         Eigen::AngleAxisd(between.linear()).angle() < kSameFrameRad;
}

// Stores the mesh's frame in a stable pose of this mesh that has none.
absl::Status KeepMeshPose(Client& client, const rendering::Workpiece& part,
                          const std::string& name) {
  if (!part.object_mesh) return absl::OkStatus();
  const absl::StatusOr<v1::StablePose> known = client.GetStablePose(name);
  if (absl::IsNotFound(known.status()))
    return absl::OkStatus();  // it will be created with the frame
  if (!known.ok()) return known.status();
  if (known->has_mesh_pose()) {
    if (IsSameFrame(files::FromMessage(known->mesh_pose()), *part.object_mesh))
      return absl::OkStatus();
    return absl::FailedPreconditionError(
        absl::StrCat(name,
                     " has the frame of another mesh; delete the object, teach another name, or "
                     "keep that frame with --add"));
  }
  v1::UpdateStablePoseRequest request;
  request.mutable_stable_pose()->set_name(name);
  request.mutable_stable_pose()->set_etag(known->etag());
  *request.mutable_stable_pose()->mutable_mesh_pose() = files::ToMessage(*part.object_mesh);
  request.mutable_update_mask()->add_paths("mesh_pose");
  return client.UpdateStablePose(request).status();
}

// Existing views of a stable pose must be of this mesh, camera and place; its first view is
// checked.
absl::Status CheckOwn(Client& client, const Turntable& turntable, std::size_t part) {
  v1::UploadViewsRequest first;
  RETURN_IF_ERROR(turntable.Make(part * turntable.steps(), &first));
  const absl::StatusOr<std::vector<v1::View>> views = client.ListViews(first.parent());
  if (absl::IsNotFound(views.status())) return absl::OkStatus();
  if (!views.ok()) return views.status();
  const std::string name = absl::StrCat(first.parent(), "/views/", files::ContentId(first.view()));
  if (views->empty() || std::ranges::find(*views, name, &v1::View::name) != views->end()) {
    return absl::OkStatus();
  }
  return absl::FailedPreconditionError(absl::StrCat(
      first.parent(), " has ", views->size(),
      " views that are not of this mesh, camera and place; delete the object, teach another "
      "name, or teach these views beside them with --add"));
}

}  // namespace

absl::StatusOr<Pose> StandOf(const v1::Cell& cell) {
  if (!cell.has_sensor_pose()) {
    return absl::FailedPreconditionError(
        absl::StrCat(cell.name(),
                     " has no sensor pose; calibrate it, or give --look-down and "
                     "--distance in place of --cell"));
  }
  RETURN_IF_ERROR(files::CheckPose(cell.sensor_pose(), "sensor_pose"));
  Pose sensor = files::FromMessage(cell.sensor_pose());
  const Vector3d axis = sensor.linear().col(2);
  const double height = sensor.translation().z();
  const bool looks_down = axis.z() < -kMinFall && height > 0;
  Vector3d target = Vector3d::Zero();
  if (looks_down) target = sensor.translation() - axis * (height / axis.z());
  const v1::AxisAlignedBox& region = cell.region_of_interest();
  if (cell.has_region_of_interest() && (!looks_down || !IsWithin(region, target))) {
    target = Vector3d((region.min().x() + region.max().x()) / 2,
                      (region.min().y() + region.max().y()) / 2, 0);
  } else if (!looks_down) {
    return absl::FailedPreconditionError(absl::StrCat(
        "the camera of ", cell.name(), " does not look down at the table; check its sensor pose"));
  }
  sensor.translation() -= target;
  return sensor;
}

std::size_t CountOf(const std::vector<rendering::Workpiece>& parts, const CadViews& views) {
  return parts.size() * static_cast<std::size_t>(StepsOf(views.step_deg));
}

absl::StatusOr<UploadCounts> TeachCadViews(Client& client,
                                           const std::vector<rendering::Workpiece>& parts,
                                           const CadViews& views, const UploadWatch& watch) {
  RETURN_IF_ERROR(CheckStep(views.step_deg));
  ASSIGN_OR_RETURN(const Turntable turntable, Turntable::Create(parts, views));
  for (std::size_t part = 0; part < parts.size() && !views.beside_others; ++part) {
    RETURN_IF_ERROR(CheckOwn(client, turntable, part));
  }
  for (std::size_t part = 0; part < parts.size() && !views.beside_others; ++part) {
    const std::string name = StablePoseName(parts[part].object_id, parts[part].stable_pose_id);
    RETURN_IF_ERROR(KeepMeshPose(client, parts[part], name));
  }
  std::vector<v1::CapturedObject> declared;
  declared.reserve(parts.size());
  for (const rendering::Workpiece& part : parts) declared.push_back(rendering::DeclarationOf(part));
  RETURN_IF_ERROR(CreateParents(client, declared));
  return TeachViews(
      client,
      {.count = turntable.count(),
       .make = [&](std::size_t i,
                   v1::UploadViewsRequest* request) { return turntable.Make(i, request); }},
      watch);
}

}  // namespace graspdb::client
