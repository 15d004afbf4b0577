// The ways in which a mesh rests on a table, as a catalogue wants them: few, and each looks
// different from the others.
#pragma once

#include <numbers>
#include <vector>

#include "absl/status/statusor.h"
#include "client/teaching/mesh/convex_hull.h"
#include "client/teaching/mesh/resting.h"
#include "recognition/base/types.h"
#include "recognition/models/shape_similarity.h"
#include "rendering/mesh.h"

namespace graspdb::client {

// One stable pose of a mesh.
struct MeshStablePose {
  // T_object_mesh: the mesh as it rests. The object's frame has z up and rests on z = 0; its
  // origin lies below the middle of the bounding box, or on the axis of the symmetry.
  recognition::Pose object_mesh = recognition::Pose::Identity();
  // That a dropped object comes to rest so, or so that it looks the same: 0 to 1.
  double probability = 0;
  // By how much the table must be tilted before it tips over, rad.
  double tip_angle_rad = 0;
  // It rolls on over facets that are less than 20 degrees apart: what lies 12 degrees and more from
  // this orientation, and looks different, is another stable pose.
  bool rolls = false;
  // Facets of the hull that are this pose.
  int facet_count = 0;
  // The turns about z that bring it onto itself. Of no more than nearly symmetric objects: order 1
  // is to be declared.
  recognition::FoundSymmetry symmetry;

  int symmetry_order() const { return symmetry.nearly ? 1 : symmetry.order; }
};

struct MeshStablePoses {
  std::vector<MeshStablePose> poses;  // the most probable first
  double left_out = 0;                // probability of the others
  MassCenter mass;                    // mesh frame
};

// Which stable poses are wanted.
struct StablePoseChoice {
  double min_probability = 0;
  // Stable poses with at least this tip angle are kept whatever their probability, rad: a bottle is
  // put upright and not dropped. The default keeps none, as a tip angle is less than pi / 2.
  double stands_rad = std::numbers::pi;
};

// All stable poses of `choice`, see RestingFacets. One pose are facets between
// which the centre of mass is lifted by less than 0.5 % of the diameter (curved and noisy
// surfaces) and that are less than 12 degrees apart (1 degree where more than 5 % of all drops end
// on each of the two: the object rocks), and all poses that look the same on the table to a depth
// camera (recognition::FindShapeSimilarity within 1.5 mm, where both roll within AlikeM): the sides
// of a cylinder are one, so are the faces of a cube. Where none is chosen, the most probable one
// is.
//
// Deterministic; thread-safe. INVALID_ARGUMENT as CheckMesh; errors as HullOf and RestingFacets.
absl::StatusOr<MeshStablePoses> FindStablePoses(const TriangleMesh& mesh,
                                                const StablePoseChoice& choice);

// T_object_mesh of a mesh that rests with `down` (mesh frame, length one): the lowest point on z =
// 0, the middle of the bounding box on the z axis, turned as little as possible.
recognition::Pose PutDown(const TriangleMesh& mesh, const Eigen::Vector3d& down);

}  // namespace graspdb::client
