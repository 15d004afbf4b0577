// How well a detection is held in each direction.
#pragma once

#include <Eigen/Core>

#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {

// A small turn (rad), then a small shift (m).
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Covariance of a target that was found at `sensor_target`, in the frame of the target: its points
// hold it across its surfaces, its edges a little along them, and the table under it, where it
// stands on one, upright and at its height. What points in `points` (sensor frame, m) do not lie on
// it say nothing. Of twelve views of a flat object from above none says well where it is on the
// table and how it is turned; those from the side do.
Matrix6d CovarianceOf(const recognition::SurfaceModel& model, const recognition::Points& points,
                      const recognition::Pose& sensor_target, bool on_table);

// Where nothing is known of a detection, and of a robot's flange: 0.2 degrees and 0.5 mm in each
// direction.
Matrix6d UsualCovariance();

}  // namespace graspdb::client
