#include "recognition/descriptors/heading.h"

#include <algorithm>

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;

// Sine of the angle between line of sight and vertical: up to kSteep the image alone gives the
// direction, from kOblique on the line of sight.
constexpr double kSteep = 0.2;
constexpr double kOblique = 0.4;
// Shorter vectors have no direction.
constexpr double kMinHorizontal = 1e-5;

// The horizontal unit vector; zero for a vertical `v`.
Vector3d Level(const Vector3d& v) {
  const Vector3d level(v.x(), v.y(), 0);
  return level.norm() < kMinHorizontal ? Vector3d::Zero() : Vector3d(level.normalized());
}

}  // namespace

Vector3d SideSeen(const Pose& world_sensor, const Vector3d& point) {
  const Vector3d depth_buffer = (world_sensor.translation() - point).normalized();
  const double oblique =
      std::clamp((depth_buffer.head<2>().norm() - kSteep) / (kOblique - kSteep), 0.0, 1.0);
  const Vector3d down = Level(world_sensor.linear().col(1));
  const Vector3d side = Level(oblique * Level(depth_buffer) + (1 - oblique) * down);
  return side.isZero() ? Vector3d::UnitX() : side;
}

}  // namespace graspdb::recognition
