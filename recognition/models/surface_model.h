// What a stable pose looks like from all around: its views, fused.
#pragma once

#include <memory>
#include <span>
#include <utility>

#include "recognition/base/types.h"
#include "recognition/models/fusion.h"
#include "recognition/points/nearest_grid.h"
#include "recognition/simd/soa_cloud.h"

namespace graspdb::recognition {

// Neighbours on one surface are about so far apart, in scans as in models, m.
inline constexpr float kSurfaceSpacingM = 0.003F;

// Points with normals that cover a surface, about `spacing_m` metres apart.
struct Surface {
  Surface(OrientedCloud covering, float spacing)
      : cloud(std::move(covering)), columns(cloud), spacing_m(spacing) {}

  OrientedCloud cloud;
  SoaCloud columns;  // the same
  float spacing_m;
};

// A surface in the frame of the stable pose, metres. Immutable.
struct SurfaceModel {
  SurfaceModel(OrientedCloud fused, int view_count);

  std::size_t bytes() const;

  // Distance of `p` (object frame, m) from the surface: across it, and along it where the
  // surface has ended. 1 m where the grid knows nothing.
  float DistanceTo(const Eigen::Vector3f& p) const;

  // For SIMD code.
  simd::LookUp look_up() const { return grid.LookUpIn(fine.cloud); }

  Surface fine;
  Surface coarse;    // some hundred of the same points, for first looks
  NearestGrid grid;  // over fine.cloud.points
  int view_count = 0;
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  // of the bounding box
  float radius_m = 0;                                // of the sphere around the center
  // Root mean square distance of the fused views' points from the surface: the noise of the
  // camera, and what the views were taught apart from each other. 0 where it is not known.
  float deviation_m = 0;
};

// What the views of one stable pose make, fused (fusion.h), with its deviation. Null without
// points. Deterministic.
std::shared_ptr<const SurfaceModel> FuseViews(std::span<const PosedCloud> views);

}  // namespace graspdb::recognition
