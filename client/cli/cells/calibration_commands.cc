#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/calibration/table_level.h"
#include "client/cli/cells/cell_saving.h"
#include "client/cli/cells/commands.h"
#include "client/cli/cells/table_scan.h"
#include "files/messages/pose_message.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using recognition::kDegreesPerRadian;
using recognition::kMmPerM;
using recognition::Pose;

constexpr char kLevelFooter[] =
    R"(Fits the plane of the empty table and sets the height and level of the cell's sensor pose.
Keeps x, y and the turn about the vertical if the cell has a pose; else the origin is under
the image centre. Creates the cell if it does not exist.

Example:
  graspdb cells level press-3 --frame empty-table.pcd
  graspdb cells level press-3 --sensor freenect)";

struct CalibrationOptions {
  std::string id;
  std::string frame;
  std::string sensor;
};

absl::Status Level(const GlobalOptions& global, const CalibrationOptions& options) {
  ASSIGN_OR_RETURN(const StillScan scan, TableFrom(options.frame, options.sensor));
  ASSIGN_OR_RETURN(const DetectedTable table, FindTable(scan.points));
  Client client = Connect(global);
  absl::StatusOr<v1::Cell> cell = client.GetCell(ResourceName("cells", options.id));
  const bool is_there = cell.ok();
  if (absl::IsNotFound(cell.status())) {
    cell = v1::Cell();
    cell->set_name(ResourceName("cells", options.id));
  }
  if (!cell.ok()) return cell.status();
  if (cell->has_flange_sensor_pose()) {
    return absl::FailedPreconditionError(
        absl::StrCat("the camera of ", options.id, " is on the robot's flange and needs no level"));
  }
  const std::optional<Pose> before = cell->has_sensor_pose()
                                         ? std::optional(files::FromMessage(cell->sensor_pose()))
                                         : std::nullopt;
  ASSIGN_OR_RETURN(const Pose level, LevelOn(table, before));
  v1::UpdateCellRequest update;
  update.mutable_update_mask()->add_paths("sensor_pose");
  *cell->mutable_sensor_pose() = files::ToMessage(level);
  *update.mutable_cell() = *std::move(cell);
  ASSIGN_OR_RETURN(const v1::Cell saved, SaveCell(client, update, is_there));
  if (global.json) return PrintJson(saved);
  std::printf("table: rms %.2f mm, %.0f %% of the points; camera %.1f mm above it\n",
              kMmPerM * table.rms_m, 100 * table.share, kMmPerM * level.translation().z());
  if (!before) return absl::OkStatus();
  std::printf("changed: tilt %.2f degrees, height %+.1f mm\n",
              kDegreesPerRadian * LevelErrorOf(table, *before).tilt_rad,
              kMmPerM * (level.translation().z() - before->translation().z()));
  return absl::OkStatus();
}

}  // namespace

void AddLevelCommand(CLI::App& cells, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<CalibrationOptions>();
  CLI::App* level =
      AddCommand(cells, "level", "Calibrate the camera's height and level over the table");
  level->add_option("CELL", options->id, "Id, e.g. press-3")->required();
  CLI::Option_group* table = level->add_option_group("table", "The empty table");
  table->add_option("--frame", options->frame, "A frame of the table, .pcd or .ply");
  table->add_option("--sensor", options->sensor, "The camera above it, e.g. freenect");
  table->require_option(1);
  level->footer(kLevelFooter);
  level->callback([=, &global] { *action = [=, &global] { return Level(global, *options); }; });
}

}  // namespace graspdb::client
