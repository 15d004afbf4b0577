// How a camera stands over its table, from a frame of the empty table.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"
#include "recognition/points/plane.h"

namespace graspdb::client {

// The table as a camera sees it.
struct SeenTable {
  recognition::Plane plane;  // sensor frame, m; the normal towards the camera
  double rms_m = 0;          // of the points on it
  double share = 0;          // of all points within 1.5 m that lie on it, 0 to 1
};

// The plane of most points within 1.5 m (sensor frame, m). FAILED_PRECONDITION, with what to do,
// when less than a third of them lie on one, or when the camera looks along it, more than 75
// degrees from its normal.
absl::StatusOr<SeenTable> FindTable(const recognition::Points& points);

// T_world_sensor with the table at z = 0 and z up from it. With a pose `before` x, y and the turn
// about the vertical stay; else the origin is under the image centre and x to the image's right.
// FAILED_PRECONDITION when the plane is tilted by more than 15 degrees against `before`, as another
// one than the table is; without `before`, when the image's right points out of the table.
absl::StatusOr<recognition::Pose> LevelOn(const SeenTable& table,
                                          const std::optional<recognition::Pose>& before);

// How far a camera's pose is off a table: how high the table stands above z = 0 under the image
// centre, and how it is tilted against the world.
struct LevelError {
  double height_m = 0;
  double tilt_rad = 0;
};
LevelError LevelErrorOf(const SeenTable& table, const recognition::Pose& world_sensor);

}  // namespace graspdb::client
