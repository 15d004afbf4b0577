#include "lab/experiment/bigbird_trials.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <system_error>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "files/point_file.h"
#include "lab/datasets/bigbird_object.h"
#include "rendering/mesh_file.h"

namespace graspdb::client {
namespace {

namespace fs = std::filesystem;
using recognition::Pose;

// Objects of BigBIRD stand upright, each in one way.
constexpr char kStablePose[] = "upright";
// Where depth maps show the object: over the turntable, whose edge and surroundings stay out.
recognition::Box OverTurntable() { return {{-0.15, -0.15, -0.03}, {0.15, 0.15, 0.40}}; }
// A segmented cloud whose middle is farther from the axis shows something else, or is not in metres
// or not in its camera's frame.
constexpr double kOffTurntableM = 0.30;
// A mesh that is farther than this from a cloud of its object, on average, is not where that is.
constexpr double kOffMeshM = 0.01;

// A view of a part.
struct Shot {
  BigBirdView view;
  std::size_t part = 0;
  Pose world_object = Pose::Identity();
};

// The objects in `folder`, or the one that it is of; by name.
std::vector<fs::path> FoldersIn(const fs::path& folder) {
  if (IsBigBirdObject(folder)) return {folder};
  std::vector<fs::path> out;
  std::error_code error;  // what cannot be listed has nothing in it
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (IsBigBirdObject(entry->path())) out.push_back(entry->path());
  }
  std::ranges::sort(out);
  return out;
}

absl::StatusOr<std::vector<fs::path>> Chosen(const fs::path& folder,
                                             const std::vector<std::string>& names) {
  std::vector<fs::path> out;
  if (names.empty()) out = FoldersIn(folder);
  for (const std::string& name : names) {
    out.push_back(folder / name);
    if (IsBigBirdObject(out.back())) continue;
    return absl::InvalidArgumentError(absl::StrCat(folder.string(), " has no object ", name,
                                                   "; name folders with a calibration.h5"));
  }
  if (!out.empty()) return out;
  return absl::NotFoundError(
      absl::StrCat(folder.string(),
                   " has no folder of an object; name one whose folders have a calibration.h5"));
}

absl::Status CheckOverTurntable(const Shot& shot, const recognition::Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (const Eigen::Vector3f& p : points) {
    if (!p.allFinite()) continue;
    sum += p.cast<double>();
    ++count;
  }
  if (count == 0) return absl::OkStatus();  // who needs to see something, says so
  const double off = (shot.view.world_sensor * Eigen::Vector3d(sum / count)).head<2>().norm();
  if (off <= kOffTurntableM) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "%s lies %.2f m from the axis of the turntable; clouds must be in metres and in the frame of "
      "their RGB camera",
      shot.view.path.string(), off));
}

absl::StatusOr<recognition::Points> ReadPoints(const Shot& shot) {
  if (shot.view.lens) return ReadDepthMap(shot.view.path, *shot.view.lens);
  auto file = ReadPointFile(shot.view.path);
  if (!file.ok()) return file.status();
  absl::Status over = CheckOverTurntable(shot, file->points);
  if (!over.ok()) return over;
  return std::move(file->points);
}

absl::StatusOr<Trial> Read(const Shot& shot) {
  auto points = ReadPoints(shot);
  if (!points.ok()) return points.status();
  Trial out{.scan = {.points = *std::move(points),
                     .world_sensor = shot.view.world_sensor,
                     .region = std::nullopt,
                     .segmented = !shot.view.lens},
            .truth = {{.part = shot.part, .world_object = shot.world_object}},
            .seen = {shot.world_object.translation()},
            .file = shot.view.path.string()};
  if (shot.view.lens) out.scan.region = OverTurntable();
  return out;
}

absl::Status CheckMeshIsThere(const Shot& shot, const fs::path& mesh, const MeasuredShape& shape) {
  if (shot.view.lens) return absl::OkStatus();  // shows the turntable too
  const auto points = ReadPoints(shot);
  if (!points.ok()) return points.status();
  const Eigen::Isometry3f object_sensor =
      (shot.world_object.inverse() * shot.view.world_sensor).cast<float>();
  double sum = 0;
  double count = 0;
  for (const Eigen::Vector3f& p : *points) {
    if (!p.allFinite()) continue;
    sum += std::sqrt(static_cast<double>(shape.search.Nearest(object_sensor * p).squared_distance));
    ++count;
  }
  if (sum <= kOffMeshM * count) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "%s is %.0f mm from what %s shows; put it into the frame of the turntable, or away",
      mesh.string(), 1e3 * sum / count, shot.view.path.string()));
}

// The frame of the object in that of the table: below the middle of its mesh, about which it may be
// symmetric; the table's without a mesh.
Pose TableObject(const TriangleMesh& mesh_on_table) {
  Pose out = Pose::Identity();
  const recognition::Box box = BoundsOf(mesh_on_table);
  out.translation().head<2>() = ((box.min + box.max) / 2).head<2>();
  return out;
}

// Adds the object as a part; gives its views.
absl::StatusOr<std::vector<Shot>> AddObject(const BigBirdObject& object, PartSet* set) {
  Workpiece part{.object_id = object.id,
                 .display_name = "",
                 .stable_pose_id = kStablePose,
                 .grasps = {},
                 .mesh = {}};
  Pose table_object = Pose::Identity();
  if (!object.mesh.empty()) {
    const auto mesh = LoadMesh(object.mesh);
    if (!mesh.ok()) return mesh.status();
    table_object = TableObject(Transformed(*mesh, object.table_mesh));
    part.mesh = Transformed(*mesh, table_object.inverse() * object.table_mesh);
  }
  set->Add(std::move(part), table_object.inverse() * object.table_mesh);
  std::vector<Shot> out;
  for (const BigBirdView& view : object.views) {
    out.push_back({view, set->parts.size() - 1, view.world_table * table_object});
  }
  if (!set->shapes.back()) return out;
  absl::Status there = CheckMeshIsThere(out.front(), object.mesh, *set->shapes.back());
  if (!there.ok()) return there;
  return out;
}

TrialSource TrialsOf(std::vector<Shot> shots) {
  auto shared = std::make_shared<const std::vector<Shot>>(std::move(shots));
  return {shared->size(), [shared](std::size_t i) { return Read((*shared)[i]); }};
}

}  // namespace

bool IsBigBird(const fs::path& folder) { return !FoldersIn(folder).empty(); }

absl::StatusOr<CaptureTrials> LoadBigBirdTrials(const fs::path& folder,
                                                const BigBirdOptions& options) {
  const auto folders = Chosen(folder, options.objects);
  if (!folders.ok()) return folders.status();
  CaptureTrials out;
  std::vector<Shot> taught;
  std::vector<Shot> asked;
  for (const fs::path& of_object : *folders) {
    const auto object = LoadBigBirdObject(of_object, options.cameras);
    if (!object.ok()) return object.status();
    auto shots = AddObject(*object, &out.set);
    if (!shots.ok()) return shots.status();
    const std::size_t taught_before = taught.size();
    for (Shot& shot : *shots) {
      (shot.view.turn_deg % options.teach_step_deg == 0 ? taught : asked)
          .push_back(std::move(shot));
    }
    if (taught.size() == taught_before) {
      return absl::FailedPreconditionError(
          absl::StrCat(of_object.string(), " has no turns to teach; choose another step than ",
                       options.teach_step_deg, " degrees"));
    }
  }
  if (asked.empty()) {
    return absl::FailedPreconditionError(
        absl::StrCat(folder.string(), " has no turns to ask about; teach at larger steps than ",
                     options.teach_step_deg, " degrees"));
  }
  out.set.taught_count = out.set.parts.size();
  out.trials = {TrialsOf(std::move(taught)), TrialsOf(std::move(asked)), false};
  return out;
}

}  // namespace graspdb::client
