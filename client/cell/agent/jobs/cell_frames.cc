#include "client/cell/agent/jobs/cell_frames.h"

#include "base/status_macros.h"
#include "files/messages/pose_message.h"

namespace graspdb::client {
namespace {

using recognition::Pose;

absl::StatusOr<std::optional<Pose>> CheckedPose(bool given, const v1::Pose& message,
                                                std::string_view field) {
  if (!given) return std::optional<Pose>();
  RETURN_IF_ERROR(files::CheckPose(message, field));
  return std::optional<Pose>(files::FromMessage(message));
}

}  // namespace

absl::StatusOr<CellFrames> FramesOf(const v1::Cell& cell) {
  const auto base =
      CheckedPose(cell.has_robot_base_pose(), cell.robot_base_pose(), "robot_base_pose");
  const auto sensor = CheckedPose(cell.has_sensor_pose(), cell.sensor_pose(), "sensor_pose");
  const auto flange =
      CheckedPose(cell.has_flange_sensor_pose(), cell.flange_sensor_pose(), "flange_sensor_pose");
  absl::Status status = base.status();
  status.Update(sensor.status());
  status.Update(flange.status());
  if (!status.ok()) return status;
  return CellFrames{base->value_or(Pose::Identity()), *sensor, *flange};
}

absl::StatusOr<Pose> WorldSensor(const CellFrames& frames, const std::optional<Pose>& base_flange,
                                 const std::optional<Pose>& frame) {
  if (frames.flange_sensor) {
    if (base_flange) return frames.world_base * *base_flange * *frames.flange_sensor;
    return absl::InvalidArgumentError(
        "the camera is on the robot; send the flange pose with the request");
  }
  if (frames.world_sensor) return *frames.world_sensor;
  if (frame) return *frame;
  return absl::FailedPreconditionError(
      "the pose of the cell's camera is unknown; run graspdb cells level, or calibrate it with the "
      "robot");
}

}  // namespace graspdb::client
