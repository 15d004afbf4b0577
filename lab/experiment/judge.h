// Answers held against the truth.
#pragma once

#include <memory>
#include <vector>

#include "recognition/points/point_search.h"
#include "recognition/recognizer.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// What poses of a workpiece are measured with.
struct MeasuredShape {
  recognition::Points points;  // on the surface, object frame, m
  recognition::PointSearch search;
  double diameter_m = 0;
  // Turns about z that bring the shape onto itself, rad; always with 0. Any turn does when
  // `any_turn`.
  std::vector<double> turns_rad;
  bool any_turn = false;
  bool is_round = false;  // after any turn every point would still be strictly right
};

MeasuredShape Measure(const Workpiece& part);

// Turns about z of a declared symmetry that has some, rad; see TaughtStablePose.
std::vector<double> TurnsOf(int symmetry_order);

// What was taught of an object, in place of its mesh; its turns are the declared ones, see
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
// A pose of one stable pose of an object, told as one of another: both are the same mesh at rest.
// `answered_mesh` and `asked_mesh` are their T_object_mesh.
recognition::Pose AsIn(const recognition::Pose& asked_mesh, const recognition::Pose& answered_mesh,
                       const recognition::Pose& world_answered);

// No point farther off than 8 mm, or 6 % of the diameter for larger objects.
bool IsStrictlyRight(const MeasuredShape& shape, const PoseError& error);

}  // namespace graspdb::client
