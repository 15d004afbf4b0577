// Grasps from above that the shape of an object suggests.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "graspdb/v1/catalog.pb.h"
#include "rendering/mesh.h"

namespace graspdb::client {

// A gripper with two parallel fingers, metres.
struct ParallelGripper {
  double max_opening_m = 0.085;
  double finger_width_m = 0.020;   // across the way that it closes
  double finger_length_m = 0.060;  // from the tips to the palm
  double pad_height_m = 0.016;     // of what touches, up from the tips
};

// How far a gripper stays off the table, metres.
inline constexpr double kOffTableM = 0.002;

// What is to be taken: a mesh in the object's frame (z up, on the table z = 0, metres).
struct GraspedObject {
  const TriangleMesh* mesh = nullptr;
  Eigen::Vector3d mass_center = Eigen::Vector3d::Zero();
  bool any_turn = false;  // it looks the same after any turn about z
};

// Top grasps, the best first: at most two, the second one closing at 45 degrees or more from the
// first; of what looks the same after any turn one, as its symmetry gives the others. Empty where
// nothing fits.
//
// The fingers close upon two opposed faces, within 20 degrees of square (a friction of 0.36), that
// are the outermost of all that is as high as the tips or higher and as wide as the fingers: so
// they come down beside the object, and not upon it. The tips stay kOffTableM off the table, the
// palm off the object. The better, the more of the pads touches and the nearer it is to the centre
// of mass; then the narrower. Deterministic; thread-safe.
std::vector<v1::Grasp> ProposeTopGrasps(const GraspedObject& object,
                                        const ParallelGripper& gripper);

}  // namespace graspdb::client
