#include "tests/recognition/scenes/table_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace graspdb::testing {
namespace {

using Eigen::Vector3d;
using recognition::Box;
using recognition::Pose;

constexpr double kFar = std::numeric_limits<double>::infinity();

// How far along the ray the box begins (slab method); infinity when it is missed.
double Enter(const Vector3d& origin, const Vector3d& ray, const Box& box) {
  double enter = 0;
  double leave = kFar;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min[axis] - origin[axis]) / ray[axis];
    const double b = (box.max[axis] - origin[axis]) / ray[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave ? enter : kFar;
}

double EnterSolid(const Vector3d& origin, const Vector3d& ray, const Solid& solid) {
  const Pose solid_world = solid.world_solid.inverse();
  double nearest = kFar;
  for (const Box& box : solid.boxes) {
    nearest = std::min(nearest, Enter(solid_world * origin, solid_world.linear() * ray, box));
  }
  return nearest;
}

double EnterTable(const Vector3d& origin, const Vector3d& ray, double half_edge) {
  const double range = -origin.z() / ray.z();
  if (!(range > 0)) return kFar;
  const Vector3d hit = origin + range * ray;
  return std::max(std::abs(hit.x()), std::abs(hit.y())) < half_edge ? range : kFar;
}

}  // namespace

recognition::CameraIntrinsics SmallCamera() { return {160, 120, 240, 240, 79.6, 59.7}; }

Pose LookAt(const Vector3d& eye, const Vector3d& target) {
  const Vector3d z = (target - eye).normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  Pose world_sensor = Pose::Identity();
  world_sensor.linear() << x, z.cross(x), z;
  world_sensor.translation() = eye;
  return world_sensor;
}

Picture TakePicture(const Scene& scene, const Pose& world_sensor,
                    const recognition::CameraIntrinsics& camera) {
  const Vector3d eye = world_sensor.translation();
  Picture out;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vector3d in_sensor((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
      const Vector3d ray = world_sensor.linear() * in_sensor;
      double nearest = EnterTable(eye, ray, scene.table_half_edge_m);
      int shown = nearest < kFar ? kTable : kNothing;
      for (std::size_t i = 0; i < scene.solids.size(); ++i) {
        const double range = EnterSolid(eye, ray, scene.solids[i]);
        if (range >= nearest) continue;
        nearest = range;
        shown = static_cast<int>(i);
      }
      const Vector3d nan = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
      const Vector3d point = shown == kNothing ? nan : Vector3d(nearest * in_sensor);
      out.points.emplace_back(point.cast<float>());
      out.shown.push_back(shown);
    }
  }
  return out;
}

}  // namespace graspdb::testing
