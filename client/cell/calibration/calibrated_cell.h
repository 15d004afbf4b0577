// Applies a hand-eye calibration to a cell.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/calibration/hand_eye.h"
#include "graspdb/v1/cell.pb.h"
#include "graspdb/v1/cell_service.pb.h"

namespace graspdb::client {

// The update of `cell` by a calibration. Fixed camera: T_world_base from the cell's sensor pose.
// Camera on the flange: T_flange_sensor; and if the cell has no robot base pose, T_world_base from
// the target on the table: z is up from the table, the origin on it under the robot's base, x as
// the robot's. FAILED_PRECONDITION when a fixed camera's cell has no sensor pose, or when the
// target did not stand upright within reach of a robot (its z axis is parallel to the base's x).
// Clears the pose of a camera on the other mount, which would otherwise still be used. Changes
// nothing else; the etag requires that the cell is unchanged since it was read.
absl::StatusOr<v1::UpdateCellRequest> CalibratedCell(const v1::Cell& cell, const HandEye& hand_eye,
                                                     CameraMount mount);

// The mount of the cell's camera: on the flange if the cell has a flange_sensor_pose.
CameraMount MountOf(const v1::Cell& cell);

// The camera pose of `cell`: HandEye::mount_camera. FAILED_PRECONDITION, with the command to run,
// when it has none.
absl::StatusOr<recognition::Pose> MountCameraOf(const v1::Cell& cell);

// T_mount_target under an existing calibration, the mean over the samples: HandEye::mount_target.
// Needs at least one sample.
recognition::Pose MeanTarget(const std::vector<HandEyeSample>& samples, CameraMount mount,
                             const recognition::Pose& mount_camera);

}  // namespace graspdb::client
