#include "rendering/camera/ray_caster.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::rendering {
namespace {

using recognition::CameraIntrinsics;
using recognition::Pose;
using ScenePtr = std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)>;

absl::Status CheckInput(const Scene& scene, const CameraIntrinsics& k, const Pose& world_sensor) {
  constexpr int kMaxSide = 16384;
  const bool has_pixels =
      k.width > 0 && k.height > 0 && k.width <= kMaxSide && k.height <= kMaxSide;
  if (!has_pixels || !(k.fx > 0) || !(k.fy > 0) || !std::isfinite(k.fx + k.fy + k.cx + k.cy)) {
    return absl::InvalidArgumentError("the camera has no pixels or no focal length");
  }
  if (!world_sensor.matrix().allFinite()) {
    return absl::InvalidArgumentError("the pose of the camera is not finite");
  }
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const PlacedMesh& object = scene.objects[i];
    if (object.mesh == nullptr || !object.world_object.matrix().allFinite()) {
      return absl::InvalidArgumentError(absl::StrCat("object ", i, " has no mesh or no pose"));
    }
    RETURN_IF_ERROR(CheckMesh(*object.mesh));
  }
  return absl::OkStatus();
}

TriangleMesh TableTop(double half_width_m) {
  const auto w = static_cast<float>(half_width_m);
  return {.vertices = {{-w, -w, 0}, {w, -w, 0}, {w, w, 0}, {-w, w, 0}},
          .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

// Adds a mesh under the number `id`; false without memory.
bool AddGeometry(RTCDevice device, RTCScene scene, const TriangleMesh& mesh, unsigned id) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.vertices.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), mesh.triangles.size()));
  const bool has_memory = vertices != nullptr && indices != nullptr;
  if (has_memory) {
    for (const Eigen::Vector3f& v : mesh.vertices) vertices = std::copy_n(v.data(), 3, vertices);
    for (const std::array<int, 3>& t : mesh.triangles) {
      for (const int i : t) *indices++ = static_cast<unsigned>(i);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
  }
  rtcReleaseGeometry(geometry);
  return has_memory;
}

absl::StatusOr<ScenePtr> Build(RTCDevice device, const Scene& scene) {
  ScenePtr built(rtcNewScene(device), &rtcReleaseScene);
  // Without it rays pass between two triangles.
  rtcSetSceneFlags(built.get(), RTC_SCENE_FLAG_ROBUST);
  const auto table_id = static_cast<unsigned>(scene.objects.size());
  bool good = true;
  for (unsigned id = 0; id < table_id; ++id) {
    const PlacedMesh& object = scene.objects[id];
    good &= AddGeometry(device, built.get(), Transformed(*object.mesh, object.world_object), id);
  }
  if (scene.with_table) {
    good &= AddGeometry(device, built.get(), TableTop(scene.table_half_width_m), table_id);
  }
  rtcCommitScene(built.get());
  if (good && rtcGetDeviceError(device) == RTC_ERROR_NONE) return built;
  return absl::ResourceExhaustedError(
      "the ray caster has no memory for the scene; use smaller meshes");
}

// One pixel. The direction has length one along the sensor's z axis, so that the
// length of the ray is the depth.
void CastPixel(RTCScene scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
               unsigned table_id, std::size_t pixel, IdealFrame& frame) {
  RTCRayHit hit{};
  hit.ray.org_x = origin.x();
  hit.ray.org_y = origin.y();
  hit.ray.org_z = origin.z();
  hit.ray.dir_x = direction.x();
  hit.ray.dir_y = direction.y();
  hit.ray.dir_z = direction.z();
  hit.ray.tfar = std::numeric_limits<float>::infinity();
  hit.ray.mask = ~0U;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect1(scene, &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
  const Eigen::Vector3f normal(hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z);
  const float cosine = std::abs(normal.normalized().dot(direction.normalized()));
  frame.depth_m[pixel] = hit.ray.tfar;
  frame.incidence_rad[pixel] = std::acos(std::min(cosine, 1.0F));
  frame.surface[pixel] =
      hit.hit.geomID == table_id ? kTableSurface : static_cast<std::int32_t>(hit.hit.geomID);
}

}  // namespace

absl::StatusOr<RayCaster> RayCaster::Create() {
  // One thread: the scenes are small, and callers run in parallel.
  RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  if (device == nullptr) {
    return absl::InternalError(absl::StrCat("the ray caster cannot start, Embree error ",
                                            static_cast<int>(rtcGetDeviceError(nullptr))));
  }
  return RayCaster(std::shared_ptr<void>(
      device, [](void* owned) { rtcReleaseDevice(static_cast<RTCDevice>(owned)); }));
}

absl::StatusOr<IdealFrame> RayCaster::Cast(const Scene& scene, const CameraIntrinsics& intrinsics,
                                           const Pose& world_sensor) const {
  RETURN_IF_ERROR(CheckInput(scene, intrinsics, world_sensor));
  ASSIGN_OR_RETURN(ScenePtr built, Build(static_cast<RTCDevice>(device_.get()), scene));
  const auto pixels =
      static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height);
  IdealFrame frame = {.width = intrinsics.width,
                      .height = intrinsics.height,
                      .depth_m = std::vector<float>(pixels, 0.0F),
                      .incidence_rad = std::vector<float>(pixels, 0.0F),
                      .surface = std::vector<std::int32_t>(pixels, kNoSurface)};
  const Eigen::Vector3f origin = world_sensor.translation().cast<float>();
  const auto table_id = static_cast<unsigned>(scene.objects.size());
  std::size_t pixel = 0;
  for (int v = 0; v < intrinsics.height; ++v) {
    for (int u = 0; u < intrinsics.width; ++u, ++pixel) {
      const Eigen::Vector3d ray((u - intrinsics.cx) / intrinsics.fx,
                                (v - intrinsics.cy) / intrinsics.fy, 1);
      const Eigen::Vector3f direction = (world_sensor.linear() * ray).cast<float>();
      CastPixel(built.get(), origin, direction, table_id, pixel, frame);
    }
  }
  return frame;
}

}  // namespace graspdb::rendering
