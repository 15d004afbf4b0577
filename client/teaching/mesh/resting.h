// How an object comes to rest on a table when it is dropped without a bounce.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "client/teaching/mesh/convex_hull.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::client {

// Centre of mass of the mesh as a solid of constant density, mesh frame, m: of the mesh itself if
// it is closed except for small holes; otherwise of its hull, e.g. for a scan from above.
struct MassCenter {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  bool of_hull = false;
};
MassCenter CenterOfMass(const rendering::TriangleMesh& mesh, const ConvexHull& hull);

// A facet of the hull on which an object rests: its centre of mass is over the facet.
struct RestingFacet {
  int facet = 0;                                     // position in ConvexHull::facets
  Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();  // mesh frame, of length one
  double probability = 0;                            // 0 to 1
  // Facets between which it rolls with nearly no lift have the same number.
  int basin = 0;
};

// All facets on which an object with that hull and centre of mass rests, the most probable first.
// The probabilities sum to one. After K. Goldberg, B. Mirtich, Y. Zhuang, J. Craig, B. Carlisle and
// J. Canny, "Part pose statistics: estimators and experiments", IEEE Trans. Robotics and
// Automation 15(5), 1999: all orientations are equally likely, so a facet is hit with a probability
// proportional to its solid angle from the centre of mass; from an unstable facet the object rolls
// over the edge that is nearest to the projection of the centre of mass. From a facet that is
// stable only up to a tilt of one degree it also rolls, if that is downhill: no drop ends on it.
//
// Two facets share a basin if the centre of mass is lifted by at most `roll_lift_m` on the lowest
// path from the higher one to the lower one, over any facets. (That path leads over edges: over a
// corner the centre of mass is higher than beside it.)
//
// Deterministic; thread-safe. FAILED_PRECONDITION when the centre is outside of the hull.
absl::StatusOr<std::vector<RestingFacet>> RestingFacets(const ConvexHull& hull,
                                                        const Eigen::Vector3d& center,
                                                        double roll_lift_m);

// The tilt of the table at which an object that rests with `down` tips over, rad: the smallest
// angle between the vertical and the line from the centre of mass to an edge of the polygon of the
// corners within `touching_m` of the table. Below 0: it does not rest. 0 without such a polygon,
// e.g. with fewer than three corners.
double TipAngle(const ConvexHull& hull, const Eigen::Vector3d& center, const Eigen::Vector3d& down,
                double touching_m);

}  // namespace graspdb::client
