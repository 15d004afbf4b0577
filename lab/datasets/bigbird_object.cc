#include "lab/datasets/bigbird_object.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <system_error>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "lab/datasets/bigbird_calibration.h"

namespace graspdb::client {
namespace {

namespace fs = std::filesystem;
using recognition::Pose;

// Meshes of whole objects, the best first.
constexpr const char* kMeshes[] = {"textured_meshes/optimized_poisson_textured_mesh.ply",
                                   "textured_meshes/optimized_tsdf_textured_mesh.ply",
                                   "meshes/poisson_mesh.stl", "meshes/tsdf_mesh.stl"};

// Of a file called CAMERA_TURN and the ending.
std::optional<int> TurnOf(const fs::path& path, const std::string& camera,
                          const std::string& ending) {
  const std::string name = path.filename().string();
  absl::string_view digits = name;
  int turn = 0;
  const bool is_one = absl::ConsumePrefix(&digits, camera + "_") &&
                      absl::ConsumeSuffix(&digits, ending) &&
                      std::ranges::all_of(digits, [](char c) { return '0' <= c && c <= '9'; }) &&
                      absl::SimpleAtoi(digits, &turn);
  return is_one ? std::optional(turn) : std::nullopt;
}

// The views of a camera whose files end so, with camera, turn and path; none without the folder.
std::vector<BigBirdView> ListViews(const fs::path& folder, const std::string& camera,
                                   const std::string& ending) {
  std::map<int, BigBirdView> by_turn;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto turn = TurnOf(entry->path(), camera, ending);
    if (turn) {
      by_turn[*turn] = {
          .camera = camera, .turn_deg = *turn, .path = entry->path(), .lens = std::nullopt};
    }
  }
  std::vector<BigBirdView> out;
  out.reserve(by_turn.size());
  for (auto& [turn, view] : by_turn) out.push_back(std::move(view));
  return out;
}

std::vector<BigBirdView> ListViews(const fs::path& folder, const std::vector<std::string>& cameras,
                                   const std::string& ending) {
  std::vector<BigBirdView> out;
  for (const std::string& camera : cameras) {
    std::ranges::move(ListViews(folder, camera, ending), std::back_inserter(out));
  }
  return out;
}

// Where the cameras are and how the table turned, as the files say it.
struct Stage {
  std::map<std::string, Pose> sensor_reference;  // T_sensor_reference by camera
  std::map<int, Pose> table_reference;           // T_table_reference by turn
};

absl::StatusOr<Stage> ReadStage(const fs::path& folder, std::vector<BigBirdView>* views,
                                bool are_maps) {
  Stage out;
  std::map<std::string, DepthLens> lenses;
  for (BigBirdView& view : *views) {
    if (!out.table_reference.contains(view.turn_deg)) {
      const auto pose = ReadTablePose(folder, view.turn_deg);
      if (!pose.ok()) return pose.status();
      out.table_reference[view.turn_deg] = *pose;
    }
    if (!out.sensor_reference.contains(view.camera)) {
      const auto pose =
          are_maps ? ReadIrPose(folder, view.camera) : ReadRgbPose(folder, view.camera);
      if (!pose.ok()) return pose.status();
      out.sensor_reference[view.camera] = *pose;
      if (!are_maps) continue;
      const auto lens = ReadLens(folder, view.camera);
      if (!lens.ok()) return lens.status();
      lenses[view.camera] = *lens;
    }
    if (are_maps) view.lens = lenses[view.camera];
  }
  return out;
}

// Whether the cameras are on the side of the table's frame where z is negative.
bool IsUpsideDown(const Stage& stage) {
  const Pose& table_reference = stage.table_reference.begin()->second;
  double height = table_reference.translation().z();
  for (const auto& [camera, sensor_reference] : stage.sensor_reference) {
    height += (table_reference * sensor_reference.inverse()).translation().z();
  }
  return height < 0;
}

// The turn about z that is nearest to a rotation: the files' tables are measured, and tilt by a
// fraction of a degree from one to the next.
Pose NearestTurn(const Eigen::Matrix3d& rotation) {
  const double turn = std::atan2(rotation(1, 0) - rotation(0, 1), rotation(0, 0) + rotation(1, 1));
  return Pose(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
}

fs::path MeshIn(const fs::path& folder) {
  std::error_code ignored;  // what cannot be looked at is not there
  for (const char* name : kMeshes) {
    if (fs::is_regular_file(folder / name, ignored)) return folder / name;
  }
  return {};
}

// Of a folder that may be told as "." or with a slash at the end.
std::string NameOf(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

}  // namespace

bool IsBigBirdObject(const fs::path& folder) {
  std::error_code ignored;  // what cannot be looked at is not there
  return fs::exists(folder / kBigBirdCalibrationFile, ignored);
}

absl::StatusOr<BigBirdObject> LoadBigBirdObject(const fs::path& folder,
                                                const std::vector<std::string>& cameras) {
  BigBirdObject out{.id = NameOf(folder), .views = {}, .mesh = MeshIn(folder)};
  out.views = ListViews(folder / "clouds", cameras, ".pcd");
  const bool are_maps = out.views.empty();
  if (are_maps) out.views = ListViews(folder, cameras, ".h5");
  if (out.views.empty()) {
    return absl::FailedPreconditionError(
        absl::StrCat(folder.string(), " has neither clouds nor depth maps of ",
                     absl::StrJoin(cameras, " or "), "; choose other cameras or objects"));
  }
  const auto stage = ReadStage(folder, &out.views, are_maps);
  if (!stage.ok()) return stage.status();
  if (IsUpsideDown(*stage)) {
    out.table_mesh = Pose(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  }
  const Pose first = out.table_mesh * stage->table_reference.begin()->second;
  for (BigBirdView& view : out.views) {
    const Pose table_reference = out.table_mesh * stage->table_reference.at(view.turn_deg);
    view.world_table = NearestTurn(first.linear() * table_reference.linear().transpose());
    view.world_sensor =
        view.world_table * table_reference * stage->sensor_reference.at(view.camera).inverse();
  }
  return out;
}

}  // namespace graspdb::client
