// The side from which a sensor sees an object on the table.
#pragma once

#include "recognition/base/types.h"

namespace graspdb::recognition {

// The horizontal unit vector towards the side from which a sensor at `world_sensor`
// (T_world_sensor) sees `point` (world frame, m). For an oblique view, the direction to the sensor.
// For a view straight down, or along z because gravity is unknown, that direction is mostly noise,
// and turning the object turns its image alike: the lower side of the image replaces it; in
// between, a mixture. Thread-safe.
Eigen::Vector3d SideSeen(const Pose& world_sensor, const Eigen::Vector3d& point);

}  // namespace graspdb::recognition
