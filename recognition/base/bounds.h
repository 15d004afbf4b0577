// The box around points.
#pragma once

#include <Eigen/Geometry>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// The smallest box along the axes of the points' frame that holds them all; empty without points.
inline Eigen::AlignedBox3f BoundsOf(const Points& points) {
  Eigen::AlignedBox3f out;
  for (const Eigen::Vector3f& p : points) out.extend(p);
  return out;
}

}  // namespace graspdb::recognition
