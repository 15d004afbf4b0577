// Where a gripper holds the target of a calibration.
#pragma once

#include "recognition/base/types.h"

namespace graspdb::client {

// Where a gripper is asked to hold a target: less than `half_width_m` from the world's z axis along
// x and y, and 6 to 50 cm above the table; world frame, m. The less there is beside gripper and
// target, the quicker it is found and the less is taken for it.
recognition::Box GrippedRegion(double half_width_m);

}  // namespace graspdb::client
