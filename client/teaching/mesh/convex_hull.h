// The convex hull of a mesh; the only file that depends on Qhull is convex_hull.cc.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "absl/status/statusor.h"

namespace graspdb::client {

// A plane face of a hull: triangles in one plane.
struct HullFacet {
  // A side of the facet: from the corner `from` to `to`, counter-clockwise seen from outside.
  struct Edge {
    int from = 0;
    int to = 0;
    int neighbor = 0;  // the facet beyond it
  };

  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // outwards, of length one
  double offset_m = 0;                               // normal . x of its plane
  std::vector<std::array<int, 3>> triangles;         // counter-clockwise seen from outside
  std::vector<Edge> edges;
};

// In the frame of the points, metres. Corners are positions in `points`.
struct ConvexHull {
  std::vector<Eigen::Vector3d> points;  // the corners alone
  std::vector<HullFacet> facets;
};

// By Qhull (C. B. Barber, D. P. Dobkin and H. Huhdanpaa, "The Quickhull algorithm for convex
// hulls", 1996). Neighbouring triangles whose normals differ by less than 2e-4 rad are one facet,
// for the single precision of mesh files. Deterministic; thread-safe.
//
// INVALID_ARGUMENT for less than four points, points that are not finite, or points in one plane;
// RESOURCE_EXHAUSTED without memory for it.
absl::StatusOr<ConvexHull> HullOf(const std::vector<Eigen::Vector3f>& points);

// Volume and centre of mass of the hull as a solid, m^3 and m.
struct HullMass {
  double volume_m3 = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
};
HullMass MassOf(const ConvexHull& hull);

}  // namespace graspdb::client
