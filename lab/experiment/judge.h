// Compares answers to the ground truth.
#pragma once

#include <memory>
#include <vector>

#include "recognition/points/point_search.h"
#include "recognition/recognizer.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// Points and symmetries to measure poses of a workpiece.
struct MeasuredShape {
  recognition::Points points;  // on the surface, object frame, m
  recognition::PointSearch search;
  double diameter_m = 0;
  // Turns about z that map the shape to itself, rad; always with 0. Any turn if `any_turn`.
  std::vector<double> turns_rad;
  bool any_turn = false;
  bool is_round = false;  // after any turn every point is still strictly right
};

MeasuredShape Measure(const Workpiece& part);

// Turns about z of a declared discrete symmetry, rad; see TaughtStablePose.
std::vector<double> TurnsOf(int symmetry_order);

// The taught model of an object, in place of its mesh, with the declared turns, see
// TaughtStablePose.
MeasuredShape Measure(const recognition::SurfaceModel& model, int symmetry_order);

// Errors of a pose. Both poses T_world_object.
struct PoseError {
  double add_s_m = 0;       // Hinterstoisser et al. 2012
  double hausdorff_m = 0;   // the largest distance of a point of one from the other, both ways
  double rotation_rad = 0;  // modulo the shape's turns
  double translation_m = 0;
};
PoseError ErrorOf(const MeasuredShape& shape, const recognition::Pose& truth,
                  const recognition::Pose& found);

// ADD-S under 5 % of the diameter.
bool IsRight(const MeasuredShape& shape, const PoseError& error);
// Converts a pose of one stable pose of an object to another one: both are the same mesh at rest.
// `answered_mesh` and `true_mesh` are their T_object_mesh.
recognition::Pose AsIn(const recognition::Pose& true_mesh, const recognition::Pose& answered_mesh,
                       const recognition::Pose& world_answered);

// No point farther off than 8 mm, or 6 % of the diameter for larger objects.
bool IsStrictlyRight(const MeasuredShape& shape, const PoseError& error);

}  // namespace graspdb::client
