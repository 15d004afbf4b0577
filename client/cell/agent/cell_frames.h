// The frames of a cell: world, robot, camera.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "graspdb/v1/cell.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

struct CellFrames {
  recognition::Pose world_base = recognition::Pose::Identity();  // T_world_base
  std::optional<recognition::Pose> world_sensor;                 // T_world_sensor, stands still
  std::optional<recognition::Pose> flange_sensor;                // T_flange_sensor, on the robot
};

// As the cell's record has them. INVALID_ARGUMENT when a pose is none.
absl::StatusOr<CellFrames> FramesOf(const v1::Cell& cell);

// T_world_sensor of a frame that was taken while the robot's flange was at `base_flange`
// (T_base_flange). `frame` is what the frame says of itself, and the last resort.
// INVALID_ARGUMENT when the camera is on the flange and nobody knows where that is;
// FAILED_PRECONDITION, with what to do, when the cell is not calibrated.
absl::StatusOr<recognition::Pose> WorldSensor(const CellFrames& frames,
                                              const std::optional<recognition::Pose>& base_flange,
                                              const std::optional<recognition::Pose>& frame);

}  // namespace graspdb::client
