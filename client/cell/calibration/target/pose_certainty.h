// The uncertainty of a detection in each direction.
#pragma once

#include <Eigen/Core>

#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {

// A small turn (rad), then a small shift (m).
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Covariance of a target detected at `sensor_target`, in the frame of the target: points constrain
// it along the surface normals, edges weakly along the surface, and the table, if `on_table`, its
// tilt and height. Points of `points` (sensor frame, m) off the target are ignored. Of twelve views
// of a flat object, those from above constrain its position on the table and its heading weakly;
// those from the side constrain both.
Matrix6d CovarianceOf(const recognition::SurfaceModel& model, const recognition::Points& points,
                      const recognition::Pose& sensor_target, bool on_table);

// The default for a detection and for a robot's flange: 0.2 degrees and 0.5 mm in each direction.
Matrix6d UsualCovariance();

}  // namespace graspdb::client
