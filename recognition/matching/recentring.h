// The last step to a pose: along what its refinement leaves loose (docs/adr/0019).
#pragma once

#include <functional>

#include "recognition/matching/refinement.h"
#include "recognition/verification/verification.h"

namespace graspdb::recognition {

// What a pose is judged by.
using Judge = std::function<Evidence(const Pose& world_object)>;

struct Recentred {
  Pose world_object = Pose::Identity();
  Evidence evidence;
};

// Residuals say little of how far an object may slide along its faces or turn about its posts, and
// what they say there is mostly noise; where its ends are, and what the camera looked through,
// says more. So the pose that `refined` has come to is moved along the one direction in which it is
// held the least, towards the middle of the poses that `judge` likes best there, as far as the
// variances of both tell. The best is looked for up to 10 mm away (at the model's rim, where it
// turns), and where the scores fall up to 10 mm from there. `held` is what holds it
// (InformationMatrixOf). Unchanged where it is held firmly. Deterministic.
Recentred Recentre(const SurfaceModel& model, const Recentred& refined,
                   const InformationMatrix& held, const Judge& judge);

}  // namespace graspdb::recognition
