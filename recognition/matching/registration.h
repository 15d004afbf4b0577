// The iterative closest point algorithm: from the rough to the refined pose.
#pragma once

#include "recognition/base/types.h"
#include "recognition/matching/matching_parameters.h"
#include "recognition/points/point_search.h"

namespace graspdb::recognition {

// Target cloud of an alignment.
struct RegistrationTarget {
  const OrientedCloud& cloud;
  const PointSearch& search;  // over cloud.points
};

// Result of an alignment.
struct Registration {
  Pose target_source = Pose::Identity();  // moves source points onto the target
  bool converged = false;                 // the last step was negligible
  int iterations = 0;
  double rms_error_m = 0;  // between corresponding points
  // Share of the source's points with a correspondence; of a model, those that face the camera.
  double inlier_fraction = 0;
};

// Aligns `source` with the target, beginning at `initial`. Correspondences are nearest points, at
// first up to max_correspondence_m apart and nearer and nearer as the alignment improves. Point to
// point (P. J. Besl, N. D. McKay, "A method for registration of 3-D shapes", 1992) or point to
// plane (Y. Chen, G. Medioni, "Object modelling by registration of multiple range images", 1992).
// Without correspondences returns the initial pose, not converged.
Registration Align(const Points& source, const RegistrationTarget& target, const Pose& initial,
                   const MatchingParameters& parameters);

// How well the points of `a` are supported by those searched by `b`: the mean of
// max(0, 1 - d^2 / support^2) over the distances d to the nearest point. 0 to 1.
double Support(const Points& a, const PointSearch& b, double support_m);

}  // namespace graspdb::recognition
