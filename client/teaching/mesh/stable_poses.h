// The stable poses of a mesh on a table, merged for a catalogue: few, and each looks different from
// the others.
#pragma once

#include <numbers>
#include <vector>

#include "absl/status/statusor.h"
#include "client/teaching/mesh/convex_hull.h"
#include "client/teaching/mesh/resting.h"
#include "recognition/base/types.h"
#include "recognition/models/shape_similarity.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::client {

// One stable pose of a mesh.
struct MeshStablePose {
  // T_object_mesh: the mesh as it rests. The object's frame has z up and rests on z = 0; its
  // origin lies below the middle of the bounding box, or on the axis of the symmetry.
  recognition::Pose object_mesh = recognition::Pose::Identity();
  // Probability that a dropped object comes to rest in this pose, or in one that looks the same.
  double probability = 0;
  // Tilt of the table at which it tips over, rad.
  double tip_angle_rad = 0;
  // It rolls over facets that are less than 20 degrees apart: orientations that are 12 degrees or
  // more from this one, and look different, are other stable poses.
  bool rolls = false;
  // Facets of the hull that are this pose.
  int facet_count = 0;
  // The turns about z that map it onto itself. For an object that is only nearly symmetric, declare
  // order 1.
  recognition::FoundSymmetry symmetry;

  int symmetry_order() const { return symmetry.nearly ? 1 : symmetry.order; }
};

struct MeshStablePoses {
  std::vector<MeshStablePose> poses;  // the most probable first
  double left_out = 0;                // probability of the others
  MassCenter mass;                    // mesh frame
};

// The selection of stable poses.
struct StablePoseChoice {
  double min_probability = 0;
  // Stable poses with at least this tip angle are kept whatever their probability, rad: bottles are
  // put upright, not dropped. The default keeps none, as tip angles are less than pi / 2.
  double stands_rad = std::numbers::pi;
};

// All stable poses of `choice`, see RestingFacets. Facets are one pose if the centre of mass is
// lifted by less than 0.5 % of the diameter between them (curved and noisy surfaces) and they are
// less than 12 degrees apart (1 degree if more than 5 % of all drops end on each of the two: the
// object rocks). Poses that look the same on the table to a depth camera are merged
// (recognition::FindShapeSimilarity within 1.5 mm; if both roll, within AlikeM): the sides of a
// cylinder are one pose, and so are the faces of a cube. If no pose meets `choice`, the most
// probable one is returned.
//
// Deterministic; thread-safe. INVALID_ARGUMENT as CheckMesh; errors as HullOf and RestingFacets.
absl::StatusOr<MeshStablePoses> FindStablePoses(const rendering::TriangleMesh& mesh,
                                                const StablePoseChoice& choice);

// T_object_mesh of a mesh that rests with `down` (mesh frame, length one): the lowest point on z =
// 0, the middle of the bounding box on the z axis, turned as little as possible.
recognition::Pose PutDown(const rendering::TriangleMesh& mesh, const Eigen::Vector3d& down);

}  // namespace graspdb::client
