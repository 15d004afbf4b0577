// An object's surface, as poses of it are judged in an image.
#pragma once

#include "recognition/base/types.h"
#include "recognition/pairs/model_aspect.h"

namespace graspdb::recognition {

struct ImageModelParameters {
  // Spacing of the points, m, and as much more as it takes to have at most max_points.
  float min_step_m = 0.0025F;
  std::size_t max_points = 4000;
};

// Object frame, m. Immutable; safe for concurrent reads.
struct ImageModel {
  OrientedCloud surface;
  float surface_step_m = 0;                          // between its neighbours
  float diameter_m = 0;                              // of the sphere around the center
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  // of the bounding box

  // What a camera at this place (object frame, m) sees. O(n) in the surface, about 0.1 ms.
  ModelAspect AspectSeenFrom(const Eigen::Vector3f& camera, std::size_t max_outline_points) const;
};

// From the points of a surface (object frame, m; unit normals outwards), or of as much of it as is
// known. O(n), about 1 ms. Deterministic.
ImageModel MakeImageModel(const OrientedCloud& surface, const ImageModelParameters& parameters);

}  // namespace graspdb::recognition
