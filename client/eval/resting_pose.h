// How a thing comes to rest on a table.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "client/simulation/mesh.h"
#include "recognition/types.h"

namespace graspdb::client {

// An attitude in which a mesh rests by itself.
struct RestingPose {
  // T_table_mesh: the lowest point on z = 0, the middle of the bounding box on the z axis.
  recognition::Pose table_mesh = recognition::Pose::Identity();
  // Share of all directions from which it rolls into this attitude, without bouncing: 0 to 1.
  double probability = 0;
};

// The attitudes with at least `min_probability`, the most probable first. A solid of constant
// density rests where the height of its centre of mass over the table is a local minimum over
// all directions; from any other it rolls downhill (K. Goldberg et al., "Part pose statistics",
// 1999). Attitudes less than 10 degrees apart are one, so that round things have few.
// Deterministic. Errors as CheckMesh and CenterOfMass.
absl::StatusOr<std::vector<RestingPose>> RestingPoses(const TriangleMesh& mesh,
                                                      double min_probability);

}  // namespace graspdb::client
