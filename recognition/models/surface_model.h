// The model of a stable pose, which is fused from its views.
#pragma once

#include <memory>
#include <span>
#include <utility>

#include "recognition/base/types.h"
#include "recognition/points/nearest_grid.h"
#include "recognition/simd/soa_cloud.h"

namespace graspdb::recognition {

// Edge of the cells and approximate spacing of a fused surface, m.
inline constexpr float kFusionCellM = 0.0025F;

// One view to fuse.
struct PosedCloud {
  std::shared_ptr<const OrientedCloud> cloud;  // world frame of its capture, m
  Pose world_object = Pose::Identity();        // T_world_object of its capture
};

// The points of all views within a cell become one, their mean; surfaces that look into opposite
// directions stay apart, and points that only one of many views has seen are left out as noise.
// Each mean is then projected onto the surface of its neighbours: otherwise noise that moves points
// of one face over the edge of a cell makes two layers. Points that coincide after that are merged.
// Object frame, metres; empty where nothing is left. Deterministic.
OrientedCloud Fused(std::span<const PosedCloud> views);

// Approximate spacing of neighbours on one surface, in scans as in models, m.
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

  // Distance of `p` (object frame, m) from the surface: across it, and along it where the surface
  // has ended. 1 m outside of the grid.
  float DistanceTo(const Eigen::Vector3f& p) const;

  // For SIMD code.
  simd::LookUp look_up() const { return grid.LookUpIn(fine.cloud); }

  Surface fine;
  Surface coarse;    // some hundred of the same points, for first looks
  NearestGrid grid;  // over fine.cloud.points
  int view_count = 0;
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  // of the bounding box
  float radius_m = 0;                                // of the sphere around the center
  // Root mean square distance of the fused views' points from the surface: the noise of the camera
  // and the misalignment of the taught views. 0 where unknown.
  float deviation_m = 0;
};

// Fuses the views of one stable pose and computes the deviation. Null without points.
// Deterministic.
std::shared_ptr<const SurfaceModel> FuseViews(std::span<const PosedCloud> views);

}  // namespace graspdb::recognition
