// Bounding box of points.
#pragma once

#include <Eigen/Geometry>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// Axis-aligned bounding box in the points' frame; empty without points.
inline Eigen::AlignedBox3f BoundsOf(const Points& points) {
  Eigen::AlignedBox3f out;
  for (const Eigen::Vector3f& p : points) out.extend(p);
  return out;
}

}  // namespace graspdb::recognition
