// The region of a gripped calibration target.
#pragma once

#include "recognition/base/types.h"

namespace graspdb::client {

// The region in which a gripper must hold the target: up to `half_width_m` from the world's z axis
// along x and y, and 6 to 50 cm above the table; world frame, m. A smaller region with fewer other
// objects gives a faster search and fewer false detections.
recognition::Box GrippedRegion(double half_width_m);

}  // namespace graspdb::client
