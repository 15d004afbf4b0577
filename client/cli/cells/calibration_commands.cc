#include <google/protobuf/struct.pb.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/calibration/calibrated_cell.h"
#include "client/cell/calibration/table_level.h"
#include "client/cell/calibration/target/target.h"
#include "client/cli/base/camera.h"
#include "client/cli/cells/commands.h"
#include "files/base/json_object.h"
#include "files/messages/pose_message.h"
#include "files/points/point_file.h"
#include "program/text/read_file.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using recognition::kDegreesPerRadian;
using recognition::kMmPerM;
using recognition::Pose;

constexpr std::size_t kMaxPosesBytes = 16 << 20;  // 100,000 lines
constexpr int kTableFrames = 5;
constexpr absl::Duration kSensorTimeout = absl::Seconds(10);

// A frame in a file, sensor frame, metres. Errors as ReadPointFile.
absl::StatusOr<StillScan> FrameFrom(const std::filesystem::path& path) {
  ASSIGN_OR_RETURN(files::PointFile file, files::ReadPointFile(path));
  return StillScan{.points = std::move(file.points), .width = file.image_width()};
}

// The frame in the file `frame`, or for "" the mean of some frames of the camera `sensor` (see
// OpenSensor), waiting some seconds for it. Errors as FrameFrom; or as OpenCamera and
// TakeStillScan.
absl::StatusOr<StillScan> TableFrom(const std::string& frame, const std::string& sensor) {
  if (!frame.empty()) return FrameFrom(frame);
  ASSIGN_OR_RETURN(const std::unique_ptr<DepthSensor> camera, OpenCamera(sensor));
  const MonotonicTime deadline = MonotonicTime::Now() + kSensorTimeout;
  AwaitFrames(*camera, deadline);
  return TakeStillScan(*camera, kTableFrames, deadline);
}

constexpr char kCheckFooter[] =
    R"(With --frame: the height and tilt error of the cell's sensor pose. With --poses and
--target: the error of the cell's hand-eye calibration at robot poses that were not used
to compute it. Each line of the file names a frame (beside the file) and T_base_flange,
metres and a quaternion:
  frame-1.pcd X Y Z QX QY QZ QW
With --json each of the two checks prints one line:
{"height_mm", "tilt_deg", "rms_mm", "share"} and {"poses"}.

Example:
  graspdb cells check press-3 --frame empty-table.pcd --target objects/block --poses poses.txt)";

struct CheckOptions {
  std::string id;
  std::string frame;
  std::string sensor;
  std::string poses;
  std::string target;
};

// T_base_flange and the frame that was taken there.
struct PosedFrame {
  std::filesystem::path frame;
  Pose base_flange = Pose::Identity();
};

absl::StatusOr<std::vector<PosedFrame>> ReadPoses(const std::string& path) {
  ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path, kMaxPosesBytes));
  std::istringstream lines(text);
  std::vector<PosedFrame> out;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::ranges::replace(line, ',', ' ');
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
    std::istringstream words(line);
    std::string frame;
    double p[7] = {};
    words >> frame;
    for (double& value : p) words >> value;
    v1::Pose pose;
    *pose.mutable_position() = files::ToMessage(Eigen::Vector3d(p));
    *pose.mutable_orientation() = files::ToMessage(Eigen::Quaterniond(p + 3));
    const std::string where = absl::StrCat(path, ", line ", number);
    if (words.fail()) {
      return absl::InvalidArgumentError(
          absl::StrCat(where, " is not FRAME X Y Z QX QY QZ QW; write all eight"));
    }
    RETURN_IF_ERROR(files::CheckPose(pose, where));
    out.push_back({std::filesystem::path(path).parent_path() / frame, files::FromMessage(pose)});
  }
  return out;
}

absl::StatusOr<std::vector<HandEyeSample>> FindTargets(Client& client, const v1::Cell& cell,
                                                       const CheckOptions& options) {
  ASSIGN_OR_RETURN(const std::vector<PosedFrame> frames, ReadPoses(options.poses));
  ASSIGN_OR_RETURN(const Target target,
                   LoadTarget(client, ResourceName("objects", options.target)));
  std::vector<HandEyeSample> out;
  for (const PosedFrame& frame : frames) {
    ASSIGN_OR_RETURN(const StillScan scan, FrameFrom(frame.frame));
    const absl::StatusOr<DetectedTarget> seen =
        MountOf(cell) == CameraMount::kFixed
            ? FindGrippedTarget(target, scan, files::FromMessage(cell.sensor_pose()), {})
            : FindTargetOnTable(client, target, scan);
    if (!seen.ok()) {
      std::fprintf(stderr, "%s: %s\n", frame.frame.c_str(),
                   std::string(seen.status().message()).c_str());
      continue;
    }
    out.push_back({frame.base_flange, seen->sensor_target, seen->covariance});
  }
  if (out.size() >= 2) return out;
  return absl::FailedPreconditionError(absl::StrCat(
      "the target was found at ", out.size(), " poses, at least two are needed; drive to more"));
}

absl::Status PrintHandEye(const std::vector<HandEyeResidual>& off) {
  HandEyeResidual most;
  for (const HandEyeResidual& pose : off) {
    std::printf("pose: off by %.2f mm, %.2f degrees\n", kMmPerM * pose.shift_m,
                kDegreesPerRadian * pose.turn_rad);
    most.shift_m = std::max(most.shift_m, pose.shift_m);
    most.turn_rad = std::max(most.turn_rad, pose.turn_rad);
  }
  std::printf("%zu poses: at most %.2f mm, %.2f degrees from their mean\n", off.size(),
              kMmPerM * most.shift_m, kDegreesPerRadian * most.turn_rad);
  return absl::OkStatus();
}

absl::Status PrintHandEyeJson(const std::vector<HandEyeResidual>& off) {
  google::protobuf::Struct document;
  files::JsonObject(&document).List(
      "poses", off, [](const HandEyeResidual& pose, files::JsonObject out) {
        out.Set(files::Json("shift_mm", kMmPerM * pose.shift_m),
                files::Json("turn_deg", kDegreesPerRadian * pose.turn_rad));
      });
  return PrintJson(document);
}

absl::Status CheckHandEyeOf(bool as_json, Client& client, const v1::Cell& cell,
                            const CheckOptions& options) {
  ASSIGN_OR_RETURN(const Pose camera, MountCameraOf(cell));
  ASSIGN_OR_RETURN(const auto samples, FindTargets(client, cell, options));
  const CameraMount mount = MountOf(cell);
  const std::vector<HandEyeResidual> off =
      CheckHandEye(samples, mount, camera, MeanTarget(samples, mount, camera));
  return as_json ? PrintHandEyeJson(off) : PrintHandEye(off);
}

absl::Status CheckLevel(bool as_json, const v1::Cell& cell, const CheckOptions& options) {
  if (!cell.has_sensor_pose() && cell.has_flange_sensor_pose()) {
    return absl::FailedPreconditionError(
        absl::StrCat("the camera of ", cell.name(),
                     " is on the robot's flange, so its pose over the table "
                     "depends on the robot; give --poses and --target"));
  }
  if (!cell.has_sensor_pose()) {
    return absl::FailedPreconditionError(
        absl::StrCat(cell.name(), " has no sensor pose; run `graspdb cells level` first"));
  }
  ASSIGN_OR_RETURN(const StillScan scan, TableFrom(options.frame, options.sensor));
  ASSIGN_OR_RETURN(const DetectedTable table, FindTable(scan.points));
  const LevelError off = LevelErrorOf(table, files::FromMessage(cell.sensor_pose()));
  if (as_json) {
    google::protobuf::Struct document;
    files::JsonObject(&document).Set(files::Json("height_mm", kMmPerM * off.height_m),
                                     files::Json("tilt_deg", kDegreesPerRadian * off.tilt_rad),
                                     files::Json("rms_mm", kMmPerM * table.rms_m),
                                     files::Json("share", table.share));
    return PrintJson(document);
  }
  std::printf(
      "table: %+.2f mm from z = 0, tilted by %.2f degrees; rms %.2f mm, %.0f %% of the "
      "points\n",
      kMmPerM * off.height_m, kDegreesPerRadian * off.tilt_rad, kMmPerM * table.rms_m,
      100 * table.share);
  return absl::OkStatus();
}

absl::Status Check(const GlobalOptions& global, const CheckOptions& options) {
  if (options.frame.empty() && options.sensor.empty() && options.poses.empty()) {
    return WrongUsage(absl::InvalidArgumentError(
        "nothing to check; give --frame or --sensor, or --poses with --target, or both"));
  }
  Client client = Connect(global);
  ASSIGN_OR_RETURN(const v1::Cell cell, client.GetCell(ResourceName("cells", options.id)));
  absl::Status status;
  if (!options.frame.empty() || !options.sensor.empty()) {
    status = CheckLevel(global.json, cell, options);
  }
  if (status.ok() && !options.poses.empty()) {
    status = CheckHandEyeOf(global.json, client, cell, options);
  }
  return status;
}

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

void AddCheckCommand(CLI::App& cells, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* check = AddCommand(cells, "check", "Measure the errors of a calibration");
  check->add_option("CELL", options->id, "Id, e.g. press-3")->required();
  CLI::Option* frame =
      check->add_option("--frame", options->frame, "Frame of the empty table, .pcd or .ply");
  check->add_option("--sensor", options->sensor, "The camera above the empty table")
      ->excludes(frame);
  CLI::Option* poses =
      check->add_option("--poses", options->poses, "File with the robot's poses and frames");
  check->add_option("--target", options->target, "Object that the frames show")->needs(poses);
  poses->needs("--target");
  check->footer(kCheckFooter);
  check->callback([=, &global] { *action = [=, &global] { return Check(global, *options); }; });
}

}  // namespace graspdb::client
