// Refinement of a rough pose of a model against a scan.
#pragma once

#include <functional>
#include <optional>

#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"
#include "recognition/points/plane.h"
#include "recognition/verification/depth_buffer.h"

namespace graspdb::recognition {

// Target of a refinement: voxels of one segment, world frame, and look-ups over them.
struct RefinementTarget {
  const OrientedCloud& cloud;
  const SoaCloud& columns;  // of all its points or a sample, for the residuals
  const NearestGrid& grid;  // over cloud.points
  const DepthBuffer& depth_buffer;
  bool on_table = true;  // the object stands on a table: `table` where it was measured, else z = 0
  std::optional<Plane> table = std::nullopt;  // world frame
};

struct RefinementOptions {
  int iterations = 10;
  // Maximum distance of correspondences at the first and at the last iteration, m.
  double first_reach_m = 0.02;
  double last_reach_m = 0.005;
  bool coarse = false;  // the model's coarse surface, for its edges
  // Whether to use residuals of the model's edges; without them it takes a third of the time, and
  // flat objects may slide.
  bool edges = true;
  // How firmly the object stands on the table: the deviations in height and tilt that a calibration
  // leaves; a quarter of them where the table was measured. Small: only place and turn on the table
  // are refined.
  double height_deviation_m = 0.002;
  double tilt_deviation_rad = 0.01;
};

// Gauss and Newton's method on distances to tangent planes (Y. Chen, G. Medioni, 1992) from the
// scan to the model; past the end of a surface on distances to its edge, from either to the other,
// which keeps flat objects from sliding, but not where something hides the rest. Tukey's weights.
// Returns T_world_object; the initial one without correspondences. Deterministic.
//
// Calls `is_known` with T_world_object after every iteration but the last, and stops where it
// returns true: the pose there is known already.
struct Refinement {
  Pose world_object = Pose::Identity();
  int iterations = 0;
  bool converged = false;  // the last step moved the model by less than 0.1 mm
  bool stopped = false;    // at a known place
};
using IsKnown = std::function<bool(const Pose& world_object)>;
Refinement Refine(const SurfaceModel& model, const RefinementTarget& target, const Pose& initial,
                  const RefinementOptions& options, const IsKnown& is_known = nullptr);

// How firmly a pose is determined: the Hessian of Refine's last step there by default, half the
// second derivatives of the sum of weighted squares (m^2) by a turn about the model's center
// (radians) and then a move (m), world frame; including the prior of the table. Zero without
// correspondences.
using InformationMatrix = Eigen::Matrix<double, 6, 6>;
InformationMatrix InformationMatrixOf(const SurfaceModel& model, const RefinementTarget& target,
                                      const Pose& world_object);

// The pose turned about `center` by a rotation vector and then moved: the six of `motion`, radians
// and m, world frame.
Pose Moved(const Pose& world_object, const Eigen::Vector3d& center,
           const Eigen::Matrix<double, 6, 1>& motion);

}  // namespace graspdb::recognition
