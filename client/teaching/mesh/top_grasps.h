// Grasps from above, computed from the shape of an object.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "graspdb/v1/catalog.pb.h"
#include "recognition/base/types.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::client {

// Points on a surface with the outward normals of their triangles, and the area that each stands
// for, m^2.
struct EvenSamples {
  recognition::OrientedCloud cloud;
  std::vector<double> areas;
};

// About `count` points, at most twice that, so that triangles made to lie along its lines do not
// fill the memory: where the surface crosses the lines of a grid, each triangle those
// along the axis that its normal is nearest to. The same surface gives the same points however it
// is divided into triangles, up to rounding. Random points would not, and with them the first of
// several equal grasps. Deterministic.
EvenSamples SampleEvenly(const rendering::TriangleMesh& mesh, int count);

// A gripper with two parallel fingers, metres.
struct ParallelGripper {
  double max_opening_m = 0.085;
  double finger_width_m = 0.020;   // across the closing direction
  double finger_length_m = 0.060;  // from the tips to the palm
  double pad_height_m = 0.016;     // of the contact surface, up from the tips
};

// Clearance of a gripper above the table, metres.
inline constexpr double kOffTableM = 0.002;

// The object to grasp: a mesh in the object's frame (z up, on the table z = 0, metres).
struct GraspedObject {
  const rendering::TriangleMesh* mesh = nullptr;
  Eigen::Vector3d mass_center = Eigen::Vector3d::Zero();
  bool any_turn = false;  // it looks the same after any turn about z
};

// Top grasps, the best first: at most two, the second one closing at 45 degrees or more from the
// first; one for an object that looks the same after any turn, as its symmetry gives the others.
// Empty if no grasp fits.
//
// The fingers close on two opposed faces, perpendicular to the closing direction within 20 degrees
// (a friction of 0.36). These are the outermost faces at and above the height of the tips, within
// the width of the fingers, so the fingers come down beside the object and not on it. The tips stay
// kOffTableM above the table, and the palm clear of the object. The score rises with the contact
// area of the pads and falls with the distance from the centre of mass and with the width. It does
// not depend on how the surface is divided into triangles. Deterministic; thread-safe.
std::vector<v1::Grasp> ProposeTopGrasps(const GraspedObject& object,
                                        const ParallelGripper& gripper);

}  // namespace graspdb::client
