// How a surface looks from one side: what is visible of it, and its outline.
#pragma once

#include <cstdint>
#include <vector>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// What a camera sees of an object from one side.
struct ModelAspect {
  Eigen::Vector3f towards_camera = Eigen::Vector3f::UnitZ();  // object frame, unit length
  std::vector<std::uint16_t> visible;                         // positions in the surface
  // Points of the outline, and the unit direction across the line of sight that leads off the
  // object there. Object frame, m.
  Points outline;
  Normals outward;
};

// What a camera at `camera` sees of `surface`, points about `spacing_m` metres apart, whose middle
// is `center`; object frame, m. At most 65,536 points, and at most `max_outline_points` of the
// outline. O(n), and 2 MB at most while it runs. Deterministic.
ModelAspect AspectSeenFrom(const OrientedCloud& surface, float spacing_m,
                           const Eigen::Vector3f& center, const Eigen::Vector3f& camera,
                           std::size_t max_outline_points);

}  // namespace graspdb::recognition
