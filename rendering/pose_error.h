// The error of a pose against the ground truth.
#pragma once

#include <vector>

#include "recognition/models/surface_model.h"
#include "recognition/points/point_search.h"
#include "rendering/workpiece.h"

namespace graspdb::rendering {

// Points and symmetries of an object, to measure poses with.
struct MeasuredShape {
  recognition::Points points;  // on the surface, object frame, m
  recognition::PointSearch search;
  double diameter_m = 0;
  // Turns about z that map the shape to itself, rad; always with 0. Any turn if `any_turn`.
  std::vector<double> turns_rad = {0};
  bool any_turn = false;
  bool is_round = false;  // after any turn every point is still strictly right
};

// The shape of a mesh in the object frame, whose turns are not searched for.
MeasuredShape Measure(const TriangleMesh& mesh);

// With the turns that map the mesh to itself.
MeasuredShape Measure(const Workpiece& part);

// The taught model of an object, in place of its mesh, with the declared turns, see
// TaughtStablePose.
MeasuredShape Measure(const recognition::SurfaceModel& model, int symmetry_order);

// Turns about z of a declared discrete symmetry, rad; see TaughtStablePose.
std::vector<double> TurnsOf(int symmetry_order);

// Errors of a pose. Both poses T_world_object.
struct PoseError {
  double add_s_m = 0;       // see AddS
  double hausdorff_m = 0;   // the largest distance of a point of one from the other, both ways
  double rotation_rad = 0;  // modulo the shape's turns
  double translation_m = 0;
};
PoseError ErrorOf(const MeasuredShape& shape, const recognition::Pose& truth,
                  const recognition::Pose& found);

// ADD-S (Hinterstoisser et al. 2012): the mean distance from each point of the shape in its true
// pose to the nearest point of the shape in the found pose, metres. Invariant to symmetries.
double AddS(const MeasuredShape& shape, const recognition::Pose& truth,
            const recognition::Pose& found);

// The angle between the rotations, rad, modulo the turns of a declared symmetry about the object's
// z axis, see TaughtStablePose.
double RotationError(const recognition::Pose& truth, const recognition::Pose& found,
                     int symmetry_order);

// ADD-S under 5 % of the diameter.
bool IsRight(const MeasuredShape& shape, double add_s_m);

// No point farther off than 8 mm, or 6 % of the diameter for larger objects.
bool IsStrictlyRight(const MeasuredShape& shape, const PoseError& error);

}  // namespace graspdb::rendering
