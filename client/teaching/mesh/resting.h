// How an object comes to rest on a table when it is dropped without a bounce.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "client/teaching/mesh/convex_hull.h"
#include "rendering/mesh.h"

namespace graspdb::client {

// Centre of mass of the mesh as a solid of constant density, mesh frame, m. Of the mesh itself
// where it is closed but for small holes; otherwise that of its hull, as of a scan from above.
struct MassCenter {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  bool of_hull = false;
};
MassCenter CenterOfMass(const TriangleMesh& mesh, const ConvexHull& hull);

// A facet of the hull on which an object rests: its centre of mass is over the facet.
struct RestingFacet {
  int facet = 0;                                     // position in ConvexHull::facets
  Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();  // mesh frame, of length one
  double height_m = 0;                               // of the centre of mass over the table
  double probability = 0;                            // 0 to 1
  // Facets from one to the other of which it rolls with nearly no lift have the same number.
  int basin = 0;
};

// All facets on which an object with that hull and centre of mass rests, the most probable first.
// The probabilities sum to one. After K. Goldberg, B. Mirtich, Y. Zhuang, J. Craig, B. Carlisle and
// J. Canny, "Part pose statistics: estimators and experiments", IEEE Trans. Robotics and
// Automation 15(5), 1999: every orientation is as likely, a facet is met with the solid angle under
// which it is seen from the centre of mass, and from a facet that does not hold it rolls over the
// edge that is nearest to what is below the centre of mass. From one that holds only up to a tilt
// of one degree it rolls too, where that is downhill: no drop ends on it.
//
// Two facets share a basin where the centre of mass need not be lifted by more than
// `roll_lift_m` on the way from the higher one to the lower one, over whatever facets. (The lowest
// way leads over edges: over a corner the centre of mass is higher than beside it.)
//
// Deterministic; thread-safe. FAILED_PRECONDITION when the centre is outside of the hull.
absl::StatusOr<std::vector<RestingFacet>> RestingFacets(const ConvexHull& hull,
                                                        const Eigen::Vector3d& center,
                                                        double roll_lift_m);

// By how much the table must be tilted before an object that rests with `down` tips over, rad: the
// smallest angle between the vertical and the way from the centre of mass to an edge of the
// polygon of those corners that are within `touching_m` of the table. Below 0: it does not rest.
// It is 0 where those are no polygon, as fewer than three.
double TipAngle(const ConvexHull& hull, const Eigen::Vector3d& center, const Eigen::Vector3d& down,
                double touching_m);

}  // namespace graspdb::client
