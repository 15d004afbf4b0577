#include "recognition/pairs/image_model.h"

#include <algorithm>

#include "recognition/base/bounds.h"
#include "recognition/points/thinned.h"

namespace graspdb::recognition {

ModelAspect ImageModel::AspectSeenFrom(const Eigen::Vector3f& camera,
                                       std::size_t max_outline_points) const {
  return recognition::AspectSeenFrom(surface, surface_step_m, center, camera, max_outline_points);
}

ImageModel MakeImageModel(const OrientedCloud& surface, const ImageModelParameters& parameters) {
  ImageModel out;
  out.center = BoundsOf(surface.points).center();
  for (const auto& p : surface.points) {
    out.diameter_m = std::max(out.diameter_m, 2 * (p - out.center).norm());
  }
  out.surface_step_m = parameters.min_step_m;
  out.surface = ThinnedToAtMost(parameters.max_points, surface, &out.surface_step_m);
  return out;
}

}  // namespace graspdb::recognition
