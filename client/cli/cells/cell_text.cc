#include "client/cli/cells/cell_text.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "files/messages/pose_message.h"
#include "program/text/printable_text.h"

namespace graspdb::client {
namespace {

std::string PoseText(const v1::Pose& pose) {
  return absl::StrFormat("at %.3f %.3f %.3f m, quaternion %.4f %.4f %.4f %.4f (x y z w)",
                         pose.position().x(), pose.position().y(), pose.position().z(),
                         pose.orientation().x(), pose.orientation().y(), pose.orientation().z(),
                         pose.orientation().w());
}

std::string BoxText(const v1::AxisAlignedBox& box) {
  return absl::StrFormat("%.3f %.3f %.3f to %.3f %.3f %.3f m", box.min().x(), box.min().y(),
                         box.min().z(), box.max().x(), box.max().y(), box.max().z());
}

// Angle of a camera below the horizon; its z axis is the line of sight.
double LookDownDeg(const v1::Pose& world_sensor) {
  const double up = files::FromMessage(world_sensor).linear()(2, 2);
  return std::asin(std::clamp(-up, -1.0, 1.0)) * 180 / std::numbers::pi;
}

std::string CameraText(const v1::Cell& cell) {
  if (cell.has_flange_sensor_pose()) {
    return absl::StrCat("on the robot's flange, ", PoseText(cell.flange_sensor_pose()));
  }
  if (!cell.has_sensor_pose()) return "unknown; calibrate it with: graspdb cells level";
  return absl::StrFormat("%s; looks down by %.1f degrees", PoseText(cell.sensor_pose()),
                         LookDownDeg(cell.sensor_pose()));
}

}  // namespace

std::string CellText(const v1::Cell& cell) {
  std::string out = absl::StrCat(cell.name(), cell.display_name().empty() ? "" : ", ",
                                 PrintableText(cell.display_name()), "\n");
  absl::StrAppend(&out, "  camera     ", CameraText(cell), "\n");
  absl::StrAppend(&out, "  robot      ",
                  cell.has_robot_base_pose() ? PoseText(cell.robot_base_pose())
                                             : "its base is the world's origin",
                  "\n");
  if (cell.has_region_of_interest()) {
    absl::StrAppend(&out, "  region     ", BoxText(cell.region_of_interest()), "\n");
  }
  if (cell.has_workspace()) {
    absl::StrAppend(&out, "  workspace  ", BoxText(cell.workspace()), "\n");
  }
  if (!cell.labels().empty()) {
    absl::StrAppend(&out, "  labels     ", absl::StrJoin(cell.labels(), ", "), "\n");
  }
  if (cell.include_drafts()) absl::StrAppend(&out, "  drafts     recognised\n");
  if (cell.has_pipeline()) {
    absl::StrAppend(&out, "  pipeline   ", cell.pipeline().ShortDebugString(), "\n");
  }
  return out;
}

}  // namespace graspdb::client
