// The table: the plane with the most points, found by random sample consensus.
#pragma once

#include <numbers>
#include <optional>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// The points p with normal . p = offset; unit normal, offset in metres.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0;

  // Signed distance of p, metres; positive on the side the normal points to.
  double Height(const Eigen::Vector3d& p) const { return normal.dot(p) - offset; }
};

// Constraints of a plane search.
struct PlaneConstraint {
  // Points nearer than this support a plane, m.
  double distance_m = 0.006;
  // A plane needs this share of the points.
  double min_share = 0.10;
  // The normal must lie within this angle of `axis`, rad; pi allows every plane.
  double max_tilt_rad = std::numbers::pi;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  // The plane must pass within this distance of the origin, m.
  double max_offset_m = 1e9;
};

// The plane that most points support (Fischler and Bolles 1981), fitted to its
// inliers by least squares; nullopt when none is supported enough. The normal
// points to the side of `viewpoint`. Deterministic: the samples are drawn with a
// fixed seed.
std::optional<Plane> FindPlane(const Points& points, const Eigen::Vector3d& viewpoint,
                               const PlaneConstraint& constraint);

// T_world_a for a plane given in frame a: z up along the plane's normal, the
// origin where the ray from `viewpoint` along `forward` meets the plane, x along
// the part of `right` that lies in the plane. Unit vectors, frame a. nullopt when
// the ray does not meet the plane or `right` is perpendicular to it.
std::optional<Pose> WorldFromPlane(const Plane& plane, const Eigen::Vector3d& viewpoint,
                                   const Eigen::Vector3d& forward, const Eigen::Vector3d& right);

}  // namespace graspdb::recognition
