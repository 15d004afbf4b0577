// From which side something on the table is seen.
#pragma once

#include "recognition/base/types.h"

namespace graspdb::recognition {

// The horizontal unit vector towards the side from which a sensor at `world_sensor`
// (T_world_sensor) sees `point` (world frame, m). Where it looks obliquely, the direction to the
// sensor. Where it looks straight down, or along z because nobody knows where down is, that
// direction is little more than noise, and turning the object turns its image alike: there it is
// the lower side of the image; in between, a mixture. Thread-safe.
Eigen::Vector3d SideSeen(const Pose& world_sensor, const Eigen::Vector3d& point);

}  // namespace graspdb::recognition
