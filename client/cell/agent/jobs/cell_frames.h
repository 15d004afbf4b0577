// The frames of a cell: world, robot, camera.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "graspdb/v1/cell.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

struct CellFrames {
  recognition::Pose world_base = recognition::Pose::Identity();  // T_world_base
  std::optional<recognition::Pose> world_sensor;                 // T_world_sensor, fixed camera
  std::optional<recognition::Pose> flange_sensor;  // T_flange_sensor, camera on the robot
};

// From the cell's record. INVALID_ARGUMENT for an invalid pose.
absl::StatusOr<CellFrames> FramesOf(const v1::Cell& cell);

// T_world_sensor of a frame that was captured with the robot's flange at `base_flange`
// (T_base_flange). `frame` is the pose stored in the frame, used if the cell has none.
// INVALID_ARGUMENT when the camera is on the flange and the flange pose is missing;
// FAILED_PRECONDITION, with the command to run, when the cell is not calibrated.
absl::StatusOr<recognition::Pose> WorldSensor(const CellFrames& frames,
                                              const std::optional<recognition::Pose>& base_flange,
                                              const std::optional<recognition::Pose>& frame);

}  // namespace graspdb::client
