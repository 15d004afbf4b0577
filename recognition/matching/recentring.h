// Recentring of a refined pose along its weakest axis (docs/adr/0019).
#pragma once

#include <functional>

#include "recognition/matching/refinement.h"
#include "recognition/verification/verification.h"

namespace graspdb::recognition {

// Computes the evidence for a pose.
using Judge = std::function<Evidence(const Pose& world_object)>;

struct Recentred {
  Pose world_object = Pose::Identity();
  Evidence evidence;
};

// Residuals constrain sliding along an object's faces and turns about its posts weakly, and are
// mostly noise there; its ends and the free space constrain them better. Moves the pose of
// `refined` along its weakest axis towards the middle of the poses with the best scores of `judge`,
// weighted by the variances of both. Searches the best score up to 10 mm away (at the model's rim
// for a turn), and the ends of the range that scores as well up to 10 mm from there. `information`:
// see InformationMatrixOf. Returns `refined` where the axis is firmly constrained. Deterministic.
Recentred Recentre(const SurfaceModel& model, const Recentred& refined,
                   const InformationMatrix& information, const Judge& judge);

}  // namespace graspdb::recognition
