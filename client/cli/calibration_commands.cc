#include "client/cli/calibration_commands.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <optional>
#include <sstream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/calibration/calibrated_cell.h"
#include "client/calibration/table_level.h"
#include "client/calibration/target.h"
#include "client/cli/camera.h"
#include "client/files/point_file.h"
#include "client/files/pose_message.h"

namespace graspdb::client {
namespace {

using recognition::Pose;

constexpr double kMmPerM = 1000;
constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
constexpr int kTableFrames = 5;
constexpr absl::Duration kSensorPatience = absl::Seconds(10);
constexpr absl::Duration kSensorPause = absl::Milliseconds(20);

constexpr char kLevelFooter[] =
    R"(Fits the plane of the empty table and sets the cell's sensor pose: its height and level, keeping
x, y and the turn about the vertical where the cell has a pose, else with the origin under the
image centre. Makes the cell where there is none.

Example:
  graspdb cells level press-3 --frame empty-table.pcd
  graspdb cells level press-3 --sensor freenect)";

constexpr char kCheckFooter[] =
    R"(With --frame: how the table lies against the cell's sensor pose. With --poses and --target: how
well the cell's calibration agrees with poses of the robot that it was not made from. Each line of
the file names a frame (beside the file) and T_base_flange, metres and a quaternion:
  frame-1.pcd X Y Z QX QY QZ QW

Example:
  graspdb cells check press-3 --frame empty-table.pcd --target objects/block --poses poses.txt)";

struct Options {
  std::string id;
  std::string frame;
  std::string sensor;
  std::string poses;
  std::string target;
};

// Where a frame comes from.
absl::StatusOr<StillScan> FrameFrom(const std::filesystem::path& path) {
  absl::StatusOr<PointFile> file = ReadPointFile(path);
  if (!file.ok()) return file.status();
  return StillScan{.points = std::move(file->points), .width = file->height > 1 ? file->width : 0};
}

// The empty table, from a file or as the camera sees it now.
absl::StatusOr<StillScan> TableFrom(const Options& options) {
  if (!options.frame.empty()) return FrameFrom(options.frame);
  const absl::StatusOr<std::unique_ptr<DepthSensor>> sensor = OpenCamera(options.sensor);
  if (!sensor.ok()) return sensor.status();
  const absl::Time deadline = absl::Now() + kSensorPatience;
  while (!(*sensor)->IsReady() && absl::Now() < deadline) absl::SleepFor(kSensorPause);
  return TakeStillScan(**sensor, kTableFrames, deadline);
}

absl::StatusOr<v1::Cell> Save(Client& client, const v1::Cell& cell) {
  if (!cell.etag().empty()) {
    v1::UpdateCellRequest update;
    *update.mutable_cell() = cell;
    update.mutable_update_mask()->add_paths("sensor_pose");
    return client.UpdateCell(update);
  }
  v1::CreateCellRequest create;
  create.set_cell_id(cell.name().substr(std::string("cells/").size()));
  *create.mutable_cell() = cell;
  return client.CreateCell(create);
}

absl::Status Level(const GlobalOptions& global, const Options& options) {
  const absl::StatusOr<StillScan> scan = TableFrom(options);
  if (!scan.ok()) return scan.status();
  const absl::StatusOr<SeenTable> table = FindTable(scan->points);
  if (!table.ok()) return table.status();
  Client client = Connect(global);
  absl::StatusOr<v1::Cell> cell = client.GetCell(ResourceName("cells", options.id));
  if (absl::IsNotFound(cell.status())) {
    cell = v1::Cell();
    cell->set_name(ResourceName("cells", options.id));
  }
  if (!cell.ok()) return cell.status();
  const std::optional<Pose> before =
      cell->has_sensor_pose() ? std::optional(FromMessage(cell->sensor_pose())) : std::nullopt;
  const absl::StatusOr<Pose> level = LevelOn(*table, before);
  if (!level.ok()) return level.status();
  *cell->mutable_sensor_pose() = ToMessage(*level);
  const absl::StatusOr<v1::Cell> saved = Save(client, *cell);
  if (!saved.ok()) return saved.status();
  if (global.json) return PrintJson(*saved);
  std::printf("table: rms %.2f mm, %.0f %% of the points; camera %.1f mm above it\n",
              kMmPerM * table->rms_m, 100 * table->share, kMmPerM * level->translation().z());
  if (!before) return absl::OkStatus();
  std::printf("changed: tilt %.2f degrees, height %+.1f mm\n",
              kDegreesPerRadian * LevelErrorOf(*table, *before).tilt_rad,
              kMmPerM * (level->translation().z() - before->translation().z()));
  return absl::OkStatus();
}

// T_base_flange and the frame that was taken there.
struct PosedFrame {
  std::filesystem::path frame;
  Pose base_flange = Pose::Identity();
};

absl::StatusOr<std::vector<PosedFrame>> ReadPoses(const std::string& path) {
  std::ifstream file(path);
  if (!file) return absl::NotFoundError(absl::StrCat("cannot read ", path, "; check the path"));
  std::vector<PosedFrame> out;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::ranges::replace(line, ',', ' ');
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
    std::istringstream words(line);
    std::string frame;
    double p[7] = {};
    words >> frame;
    for (double& value : p) words >> value;
    v1::Pose pose;
    pose.mutable_position()->set_x(p[0]);
    pose.mutable_position()->set_y(p[1]);
    pose.mutable_position()->set_z(p[2]);
    pose.mutable_orientation()->set_x(p[3]);
    pose.mutable_orientation()->set_y(p[4]);
    pose.mutable_orientation()->set_z(p[5]);
    pose.mutable_orientation()->set_w(p[6]);
    const std::string where = absl::StrCat(path, ", line ", number);
    if (words.fail()) {
      return absl::InvalidArgumentError(
          absl::StrCat(where, " is not FRAME X Y Z QX QY QZ QW; write all eight"));
    }
    if (absl::Status status = CheckPose(pose, where); !status.ok()) return status;
    out.push_back({std::filesystem::path(path).parent_path() / frame, FromMessage(pose)});
  }
  return out;
}

absl::StatusOr<std::vector<HandEyeSample>> FindTargets(Client& client, const v1::Cell& cell,
                                                       const Options& options) {
  const absl::StatusOr<std::vector<PosedFrame>> frames = ReadPoses(options.poses);
  if (!frames.ok()) return frames.status();
  const absl::StatusOr<Target> target = LoadTarget(client, ResourceName("objects", options.target));
  if (!target.ok()) return target.status();
  std::vector<HandEyeSample> out;
  for (const PosedFrame& frame : *frames) {
    const absl::StatusOr<StillScan> scan = FrameFrom(frame.frame);
    if (!scan.ok()) return scan.status();
    const absl::StatusOr<SeenTarget> seen =
        MountOf(cell) == CameraMount::kFixed
            ? FindGrippedTarget(*target, *scan, FromMessage(cell.sensor_pose()), {})
            : FindStandingTarget(client, *target, *scan);
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

absl::Status CheckHandEyeOf(Client& client, const v1::Cell& cell, const Options& options) {
  const absl::StatusOr<Pose> camera = MountCameraOf(cell);
  if (!camera.ok()) return camera.status();
  const auto samples = FindTargets(client, cell, options);
  if (!samples.ok()) return samples.status();
  const CameraMount mount = MountOf(cell);
  double shift = 0;
  double turn = 0;
  for (const HandEyeResidual& off :
       CheckHandEye(*samples, mount, *camera, MeanTarget(*samples, mount, *camera))) {
    std::printf("pose: off by %.2f mm, %.2f degrees\n", kMmPerM * off.shift_m,
                kDegreesPerRadian * off.turn_rad);
    shift = std::max(shift, off.shift_m);
    turn = std::max(turn, off.turn_rad);
  }
  std::printf("%zu poses: at most %.2f mm, %.2f degrees from their mean\n", samples->size(),
              kMmPerM * shift, kDegreesPerRadian * turn);
  return absl::OkStatus();
}

absl::Status CheckLevel(const v1::Cell& cell, const Options& options) {
  if (!cell.has_sensor_pose()) {
    return absl::FailedPreconditionError(
        absl::StrCat(cell.name(), " has no sensor pose; run `graspdb cells level` first"));
  }
  const absl::StatusOr<StillScan> scan = TableFrom(options);
  if (!scan.ok()) return scan.status();
  const absl::StatusOr<SeenTable> table = FindTable(scan->points);
  if (!table.ok()) return table.status();
  const LevelError off = LevelErrorOf(*table, FromMessage(cell.sensor_pose()));
  std::printf(
      "table: %+.2f mm from z = 0, tilted by %.2f degrees; rms %.2f mm, %.0f %% of the "
      "points\n",
      kMmPerM * off.height_m, kDegreesPerRadian * off.tilt_rad, kMmPerM * table->rms_m,
      100 * table->share);
  return absl::OkStatus();
}

absl::Status Check(const GlobalOptions& global, const Options& options) {
  Client client = Connect(global);
  const absl::StatusOr<v1::Cell> cell = client.GetCell(ResourceName("cells", options.id));
  if (!cell.ok()) return cell.status();
  if (options.frame.empty() && options.sensor.empty() && options.poses.empty()) {
    return absl::InvalidArgumentError(
        "nothing to check; give --frame or --sensor, or --poses with --target, or both");
  }
  absl::Status status;
  if (!options.frame.empty() || !options.sensor.empty()) status = CheckLevel(*cell, options);
  if (status.ok() && !options.poses.empty()) status = CheckHandEyeOf(client, *cell, options);
  return status;
}

}  // namespace

void AddLevelCommand(CLI::App& cells, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<Options>();
  CLI::App* level = AddCommand(cells, "level", "Find how the camera stands over the table");
  level->add_option("CELL", options->id, "Id, e.g. press-3")->required();
  CLI::Option_group* table = level->add_option_group("table", "The empty table");
  table->add_option("--frame", options->frame, "A frame of it, .pcd or .ply");
  table->add_option("--sensor", options->sensor, "The camera that looks at it, e.g. freenect");
  table->require_option(1);
  level->footer(kLevelFooter);
  level->callback([=, &global] { *action = [=, &global] { return Level(global, *options); }; });
}

void AddCheckCommand(CLI::App& cells, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<Options>();
  CLI::App* check = AddCommand(cells, "check", "How far off a calibration is");
  check->add_option("CELL", options->id, "Id, e.g. press-3")->required();
  CLI::Option* frame =
      check->add_option("--frame", options->frame, "Frame of the empty table, .pcd or .ply");
  check->add_option("--sensor", options->sensor, "The camera that looks at the empty table")
      ->excludes(frame);
  CLI::Option* poses =
      check->add_option("--poses", options->poses, "File with the robot's poses and frames");
  check->add_option("--target", options->target, "Object that the frames show")->needs(poses);
  poses->needs("--target");
  check->footer(kCheckFooter);
  check->callback([=, &global] { *action = [=, &global] { return Check(global, *options); }; });
}

}  // namespace graspdb::client
