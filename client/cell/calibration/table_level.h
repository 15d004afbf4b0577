// Levels a camera over its table, from a frame of the empty table.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"
#include "recognition/points/plane.h"

namespace graspdb::client {

// The table in a camera's frame.
struct DetectedTable {
  recognition::Plane plane;  // sensor frame, m; the normal towards the camera
  double rms_m = 0;          // of the points on it
  double share = 0;          // of all points within 1.5 m that lie on it, 0 to 1
};

// The plane of most points within 1.5 m (sensor frame, m). FAILED_PRECONDITION, with the next step,
// when less than a third of them lie on one, or when the camera's axis is more than 75 degrees from
// its normal.
absl::StatusOr<DetectedTable> FindTable(const recognition::Points& points);

// T_world_sensor with the table at z = 0 and z up from it. A pose `before` keeps its x, y and turn
// about the vertical; without it, the origin is under the image centre and x to the image's right.
// FAILED_PRECONDITION when the plane is tilted by more than 15 degrees against `before`, so that it
// is not the table; without `before`, when the image's right points out of the table.
absl::StatusOr<recognition::Pose> LevelOn(const DetectedTable& table,
                                          const std::optional<recognition::Pose>& before);

// Error of a camera's pose relative to a table: height of the table above z = 0 at the image
// centre, and its tilt against the world.
struct LevelError {
  double height_m = 0;
  double tilt_rad = 0;
};
LevelError LevelErrorOf(const DetectedTable& table, const recognition::Pose& world_sensor);

}  // namespace graspdb::client
