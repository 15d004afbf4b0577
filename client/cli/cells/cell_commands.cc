#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status_macros.h"
#include "client/cli/cells/commands.h"
#include "files/messages/pose_message.h"
#include "program/text/json_keys.h"
#include "program/text/printable_text.h"
#include "program/text/read_file.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

constexpr std::size_t kMaxCellBytes = 1 << 20;  // a cell has about a kilobyte
// Cameras, robots, regions and workspaces of a cell are nearer to the table and smaller, m.
constexpr double kFarthestInCellM = 20;
// A camera on the flange is nearer to it, m.
constexpr double kFarthestOnFlangeM = 3;

absl::Status CheckLength(const char* flag, double length_m, double max_m) {
  if (!(length_m > max_m)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(flag, " reaches ", length_m, " m, and no cell is larger than ", max_m,
                   " m there; lengths are metres, are these millimetres? Then divide them by ",
                   recognition::kMmPerM));
}

double LargestOf(const v1::Vector3& v) {
  return std::max({std::abs(v.x()), std::abs(v.y()), std::abs(v.z())});
}

double LargestOf(const v1::AxisAlignedBox& box) {
  return std::max(LargestOf(box.min()), LargestOf(box.max()));
}

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

struct SetOptions {
  std::string id;
  std::string from;
  bool has_display_name = false;
  std::string display_name;
  std::vector<double> sensor_pose;
  std::vector<double> robot_base_pose;
  std::vector<double> flange_sensor_pose;
  std::vector<double> region;
  std::vector<double> workspace;
  std::vector<std::string> labels;
  bool no_labels = false;
  std::optional<bool> include_drafts;
};

constexpr char kSetFooter[] =
    R"(Creates the cell, or changes the given fields and keeps the rest. --from reads a cell as
`graspdb cells show NAME --json` prints it; other flags override it.

Example:
  graspdb cells set press-3 --sensor-pose 0,-0.5,0.6,-0.891,0,0,0.454 \
      --region -0.3,-0.3,-0.02,0.3,0.3,0.4)";

void SetPose(const std::vector<double>& values, v1::Pose* out) {
  *out->mutable_position() = files::ToMessage(Eigen::Vector3d(values.data()));
  *out->mutable_orientation() = files::ToMessage(Eigen::Quaterniond(values.data() + 3));
}

void SetBox(const std::vector<double>& values, v1::AxisAlignedBox* out) {
  *out->mutable_min() = files::ToMessage(Eigen::Vector3d(values.data()));
  *out->mutable_max() = files::ToMessage(Eigen::Vector3d(values.data() + 3));
}

absl::Status ReadCell(const std::string& path, v1::Cell* cell) {
  ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path, kMaxCellBytes));
  const auto status = google::protobuf::util::JsonStringToMessage(text, cell);
  if (status.ok()) {
    const absl::Status keys = CheckJsonKeys(text);
    return keys.ok() ? keys : absl::InvalidArgumentError(absl::StrCat(path, ": ", keys.message()));
  }
  std::string reason(status.message());  // its other lines quote the text
  reason.resize(std::min(reason.size(), reason.find('\n')));
  return absl::InvalidArgumentError(absl::StrCat(
      path, " is not a cell: ", reason, "; use the output of `graspdb cells show NAME --json`"));
}

// The cell that the flags specify, with a mask of the given fields.
absl::StatusOr<v1::UpdateCellRequest> MakeUpdate(const SetOptions& options) {
  v1::UpdateCellRequest request;
  v1::Cell* cell = request.mutable_cell();
  if (!options.from.empty()) {
    RETURN_IF_ERROR(ReadCell(options.from, cell));
  }
  if (options.has_display_name) cell->set_display_name(options.display_name);
  if (!options.sensor_pose.empty()) SetPose(options.sensor_pose, cell->mutable_sensor_pose());
  if (!options.robot_base_pose.empty()) {
    SetPose(options.robot_base_pose, cell->mutable_robot_base_pose());
  }
  if (!options.flange_sensor_pose.empty()) {
    SetPose(options.flange_sensor_pose, cell->mutable_flange_sensor_pose());
  }
  if (!options.region.empty()) SetBox(options.region, cell->mutable_region_of_interest());
  if (!options.workspace.empty()) SetBox(options.workspace, cell->mutable_workspace());
  if (options.no_labels || !options.labels.empty()) {
    cell->mutable_labels()->Assign(options.labels.begin(), options.labels.end());
  }
  if (options.include_drafts) cell->set_include_drafts(*options.include_drafts);
  RETURN_IF_ERROR(CheckCellUnits(*cell));
  cell->set_name(ResourceName("cells", options.id));
  cell->clear_etag();
  auto* mask = request.mutable_update_mask();
  if (options.has_display_name || !cell->display_name().empty()) mask->add_paths("display_name");
  if (cell->has_sensor_pose()) mask->add_paths("sensor_pose");
  if (cell->has_robot_base_pose()) mask->add_paths("robot_base_pose");
  if (cell->has_flange_sensor_pose()) mask->add_paths("flange_sensor_pose");
  if (cell->has_region_of_interest()) mask->add_paths("region_of_interest");
  if (cell->has_workspace()) mask->add_paths("workspace");
  if (cell->has_pipeline()) mask->add_paths("pipeline");
  if (options.no_labels || !cell->labels().empty()) mask->add_paths("labels");
  if (options.include_drafts || cell->include_drafts()) mask->add_paths("include_drafts");
  return request;
}

absl::StatusOr<v1::Cell> CreateOrUpdate(Client& client, const v1::UpdateCellRequest& update) {
  absl::StatusOr<v1::Cell> existing = client.GetCell(update.cell().name());
  const bool is_there = existing.ok();
  if (!is_there && !absl::IsNotFound(existing.status())) return existing;
  if (is_there && update.update_mask().paths().empty()) return existing;
  return SaveCell(client, update, is_there);
}

absl::Status PrintCell(const GlobalOptions& global, const absl::StatusOr<v1::Cell>& cell) {
  if (!cell.ok()) return cell.status();
  if (global.json) return PrintJson(*cell);
  std::printf("%s", CellText(*cell).c_str());
  return absl::OkStatus();
}

absl::Status ListCells(const GlobalOptions& global) {
  ASSIGN_OR_RETURN(std::vector<v1::Cell> cells, Connect(global).ListCells());
  for (const v1::Cell& cell : cells) {
    if (global.json) {
      RETURN_IF_ERROR(PrintJson(cell));
    } else {
      std::printf(
          "%-30s %s%s\n", cell.name().c_str(),
          cell.has_sensor_pose() ? "calibrated" : "not calibrated",
          cell.display_name().empty() ? "" : (", " + PrintableText(cell.display_name())).c_str());
    }
  }
  if (cells.empty() && !global.json) {
    std::printf("there are no cells; create one with: graspdb cells set NAME\n");
  }
  return absl::OkStatus();
}

void AddSetCommand(CLI::App& cells, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<SetOptions>();
  CLI::App* set = AddCommand(cells, "set", "Create or change a cell");
  set->add_option("CELL", options->id, "Id, e.g. press-3")->required();
  set->add_option("--from", options->from, "File with the JSON of a cell");
  const CLI::Option* name =
      set->add_option("--display-name", options->display_name, "Name for people; \"\" removes it");
  set->add_option("--sensor-pose", options->sensor_pose, "T_world_sensor: X,Y,Z,QX,QY,QZ,QW")
      ->delimiter(',')
      ->expected(7);
  set->add_option("--robot-base-pose", options->robot_base_pose,
                  "T_world_base, the pose of the robot: as --sensor-pose")
      ->delimiter(',')
      ->expected(7);
  set->add_option("--flange-sensor-pose", options->flange_sensor_pose,
                  "T_flange_sensor of a camera on the robot: as --sensor-pose")
      ->delimiter(',')
      ->expected(7);
  set->add_option("--region", options->region,
                  "Region with the objects: XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, m")
      ->delimiter(',')
      ->expected(6);
  set->add_option("--workspace", options->workspace, "Region that the tool may enter, as --region")
      ->delimiter(',')
      ->expected(6);
  CLI::Option* labels =
      set->add_option("--labels", options->labels,
                      "Recognise only objects with one of these labels; replaces all labels")
          ->delimiter(',')
          ->type_name("LABEL,...");
  set->add_flag("--no-labels", options->no_labels, "Recognise all objects")->excludes(labels);
  set->add_option("--include-drafts", options->include_drafts,
                  "Recognise drafts, too, as in a test cell: true or false");
  set->footer(kSetFooter);
  set->callback([=, &global] {
    options->has_display_name = name->count() > 0;
    *action = [=, &global]() -> absl::Status {
      ASSIGN_OR_RETURN(v1::UpdateCellRequest update, MakeUpdate(*options));
      Client client = Connect(global);
      return PrintCell(global, CreateOrUpdate(client, update));
    };
  });
}

}  // namespace

void AddCellsCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* cells = AddCommand(app, "cells", "List, show, set, level, check and delete cells");
  cells->require_subcommand(1);
  AddCommand(*cells, "list", "List all cells")->callback([=, &global] {
    *action = [&global] { return ListCells(global); };
  });
  auto id = std::make_shared<std::string>();
  CLI::App* show = AddCommand(*cells, "show", "Print a cell");
  show->add_option("CELL", *id, "Id, e.g. press-3")->required();
  show->callback([=, &global] {
    *action = [=, &global] {
      return PrintCell(global, Connect(global).GetCell(ResourceName("cells", *id)));
    };
  });
  AddSetCommand(*cells, global, action);
  AddLevelCommand(*cells, global, action);
  AddCheckCommand(*cells, global, action);
  CLI::App* remove = AddCommand(*cells, "delete", "Delete a cell");
  remove->add_option("CELL", *id, "Id, e.g. press-3")->required();
  remove->callback([=, &global] {
    *action = [=, &global] { return Connect(global).DeleteCell(ResourceName("cells", *id)); };
  });
}

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

absl::Status CheckCellUnits(const v1::Cell& cell) {
  absl::Status status =
      CheckLength("--sensor-pose", LargestOf(cell.sensor_pose().position()), kFarthestInCellM);
  status.Update(CheckLength("--robot-base-pose", LargestOf(cell.robot_base_pose().position()),
                            kFarthestInCellM));
  status.Update(CheckLength("--flange-sensor-pose", LargestOf(cell.flange_sensor_pose().position()),
                            kFarthestOnFlangeM));
  status.Update(CheckLength("--region", LargestOf(cell.region_of_interest()), kFarthestInCellM));
  status.Update(CheckLength("--workspace", LargestOf(cell.workspace()), kFarthestInCellM));
  return status;
}

absl::StatusOr<v1::Cell> SaveCell(Client& client, const v1::UpdateCellRequest& update,
                                  bool is_there) {
  if (is_there) return client.UpdateCell(update);
  v1::CreateCellRequest create;
  create.set_cell_id(update.cell().name().substr(std::string("cells/").size()));
  *create.mutable_cell() = update.cell();
  return client.CreateCell(create);
}

}  // namespace graspdb::client
