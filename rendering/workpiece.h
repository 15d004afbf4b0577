// An object to simulate, with its taught grasps.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "graspdb/v1/capture_set.pb.h"
#include "recognition/base/types.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::rendering {

// An object in one stable pose. The mesh is in the object's frame, in metres: it
// rests on z = 0 with z up, and the origin is the point on the table below its
// centre.
struct Workpiece {
  std::string object_id;
  std::string display_name;
  std::string stable_pose_id;
  int symmetry_order = 1;  // about z: 1 none, n for n-fold, 0 for any turn
  std::vector<v1::Grasp> grasps;
  TriangleMesh mesh;
  // T_object_mesh of the mesh in its file, in metres; absent without a file.
  std::optional<recognition::Pose> object_mesh = {};
};

// A grasp from above with two fingers. The tool's z axis points down; its x axis,
// along which the fingers close, is turned by `closing_rad` from the object's x.
// `position` is the tool centre point in the object's frame; lengths in metres.
v1::Grasp TopGrasp(const std::string& grasp_id, const Eigen::Vector3d& position, double closing_rad,
                   double gripper_opening_m);

// Its declaration in a capture set, with the mesh at `models/{object_id}.ply`.
v1::CapturedObject DeclarationOf(const Workpiece& workpiece);

}  // namespace graspdb::rendering
