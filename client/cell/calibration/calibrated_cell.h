// What a hand-eye calibration says of a cell.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/calibration/hand_eye.h"
#include "graspdb/v1/cell.pb.h"
#include "graspdb/v1/cell_service.pb.h"

namespace graspdb::client {

// Writes a calibration into `cell`. A fixed camera: where the robot stands, T_world_base, from the
// cell's sensor pose. A camera on the flange: T_flange_sensor; and where the cell does not know
// where its robot stands, T_world_base from the target, which stood on the table: z is up from the
// table, the origin on it under the robot's base, x as the robot's.
// FAILED_PRECONDITION when a fixed camera's cell has no sensor pose, or when the target did not
// stand upright within reach of a robot (its z axis lies in the direction of the base's x).
// What the cell says of a camera on the other mount is cleared, for it would be believed. The
// request changes nothing else, and only the cell as it was read.
absl::StatusOr<v1::UpdateCellRequest> CalibratedCell(const v1::Cell& cell, const HandEye& hand_eye,
                                                     CameraMount mount);

// The mount of the cell's camera: on the flange where the cell has a flange_sensor_pose.
CameraMount MountOf(const v1::Cell& cell);

// The pose of the camera that `cell` has: HandEye::mount_camera. FAILED_PRECONDITION, with the
// command to run, when it has none.
absl::StatusOr<recognition::Pose> MountCameraOf(const v1::Cell& cell);

// T_mount_target, where the target is by an existing calibration, the mean over the samples:
// HandEye::mount_target. Needs at least one sample.
recognition::Pose MeanTarget(const std::vector<HandEyeSample>& samples, CameraMount mount,
                             const recognition::Pose& mount_camera);

}  // namespace graspdb::client
