#include "lab/experiment/trials/capture_trials.h"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/capture_sets/capture_set.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "files/scan_file.h"
#include "rendering/mesh_part.h"

namespace graspdb::lab {
namespace {

using recognition::Pose;

// Object of a capture without one.
constexpr char kNoObject[] = "unnamed";
// The server's limit of a scan's median distance from the sensor.
constexpr float kMaxMedianM = 50;

struct Source {
  std::filesystem::path folder;
  std::optional<recognition::Box> region;
  std::vector<std::pair<v1::Capture, std::size_t>> captures;  // with the positions of their parts
};

bool Shows(const v1::Capture& capture, const rendering::Workpiece& part) {
  return capture.object_id() == part.object_id && capture.stable_pose_id() == part.stable_pose_id;
}

absl::Status AddPart(const v1::Capture& capture, const std::filesystem::path& folder,
                     const v1::CaptureSet& captures, PartSet* set) {
  rendering::Workpiece part{.object_id = capture.object_id(),
                            .display_name = "",
                            .stable_pose_id = capture.stable_pose_id(),
                            .grasps = {},
                            .mesh = {}};
  for (const v1::CapturedObject& object : captures.objects()) {
    if (object.object_id() != part.object_id) continue;
    for (const v1::CapturedStablePose& pose : object.stable_poses()) {
      if (pose.stable_pose_id() != part.stable_pose_id || !pose.has_symmetry_order()) continue;
      part.symmetry_order = pose.symmetry_order();
    }
    if (object.mesh_path().empty()) continue;
    ASSIGN_OR_RETURN(part.mesh, rendering::LoadMeshInMetres(folder / object.mesh_path()));
  }
  set->Add(std::move(part), Pose::Identity());
  return absl::OkStatus();
}

// The position of the capture's part, which is added if it is new.
absl::StatusOr<std::size_t> PartOf(v1::Capture capture, const std::filesystem::path& folder,
                                   const v1::CaptureSet& captures, PartSet* set) {
  if (capture.object_id().empty()) capture.set_object_id(kNoObject);
  const auto known = std::ranges::find_if(
      set->parts, [&](const rendering::Workpiece& part) { return Shows(capture, part); });
  if (known != set->parts.end()) return static_cast<std::size_t>(known - set->parts.begin());
  RETURN_IF_ERROR(AddPart(capture, folder, captures, set));
  return set->parts.size() - 1;
}

// The server rejects such a scan, of which no answer can be right.
absl::Status CheckUnit(const recognition::Points& points, const std::string& file) {
  std::vector<float> ranges;
  ranges.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    if (p.allFinite() && !p.isZero(0)) ranges.push_back(p.norm());
  }
  if (ranges.empty()) return absl::OkStatus();  // nothing is found in it
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  if (*middle <= kMaxMedianM) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(file, " has a median distance of ", *middle,
                   " m; coordinates are in metres, are these millimetres?"));
}

absl::StatusOr<Trial> Read(const Source& source, std::size_t i) {
  const auto& [capture, part] = source.captures[i];
  ASSIGN_OR_RETURN(const auto file, files::ReadScanFile(source.folder / capture.path()));
  ASSIGN_OR_RETURN(
      auto points,
      std::visit([](const auto& scan) { return files::PointsFromMessage(scan); }, file.scan));
  RETURN_IF_ERROR(CheckUnit(points, capture.path()));
  Trial out{.scan = {.points = std::move(points),
                     .world_sensor = file.sensor_pose,
                     .region = source.region,
                     .segmented = capture.segmented()},
            .truth = {{.part = part}},
            .seen = {},
            .posed = capture.has_object_pose(),
            .file = capture.path()};
  if (capture.has_sensor_pose()) out.scan.world_sensor = files::FromMessage(capture.sensor_pose());
  if (out.posed) out.truth.front().world_object = files::FromMessage(capture.object_pose());
  out.seen.push_back(out.truth.front().world_object.translation());
  return out;
}

absl::StatusOr<Source> SourceOf(const std::vector<const v1::Capture*>& captures,
                                const std::filesystem::path& folder, const v1::CaptureSet& of,
                                PartSet* set) {
  Source out{.folder = folder, .region = std::nullopt, .captures = {}};
  if (of.has_region_of_interest()) out.region = files::FromMessage(of.region_of_interest());
  for (const v1::Capture* capture : captures) {
    ASSIGN_OR_RETURN(auto part, PartOf(*capture, folder, of, set));
    out.captures.emplace_back(*capture, part);
  }
  return out;
}

// A capture that was taught finds itself, so that its answer shows nothing.
absl::Status CheckApart(const std::vector<const v1::Capture*>& taught,
                        const std::vector<const v1::Capture*>& queried) {
  const auto shown = [](const v1::Capture& capture) {
    return std::pair(std::filesystem::path(capture.path()).lexically_normal(), capture.object_id());
  };
  std::set<std::pair<std::filesystem::path, std::string>> known;
  for (const v1::Capture* capture : taught) known.insert(shown(*capture));
  for (const v1::Capture* capture : queried) {
    if (!known.contains(shown(*capture))) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(capture->path(), " is to be taught and recognised, and would find itself; ",
                     "leave out one of the two captures, or use --leave-one-out"));
  }
  return absl::OkStatus();
}

TrialSource TrialsOf(Source source) {
  auto shared = std::make_shared<const Source>(std::move(source));
  return {shared->captures.size(), [shared](std::size_t i) { return Read(*shared, i); }};
}

}  // namespace

absl::StatusOr<CaptureTrials> LoadCaptureTrials(const std::filesystem::path& folder,
                                                bool leave_one_out) {
  ASSIGN_OR_RETURN(const auto loaded, files::LoadCaptureSet(folder));
  std::vector<const v1::Capture*> taught;
  std::vector<const v1::Capture*> queried;
  for (const v1::Capture& capture : loaded.captures()) {
    if (capture.split() == v1::Capture::QUERY) {
      queried.push_back(&capture);
    } else if (!capture.object_id().empty()) {
      taught.push_back(&capture);
    }
  }
  if (taught.empty() || (queried.empty() && !leave_one_out)) {
    return absl::FailedPreconditionError(absl::StrCat(
        folder.string(), " has no captures ", taught.empty() ? "to teach" : "to recognise",
        taught.empty() ? "; give some an object and the split TEACH"
                       : "; give some the split QUERY, or use --leave-one-out"));
  }
  if (!leave_one_out) {
    RETURN_IF_ERROR(CheckApart(taught, queried));
  }
  CaptureTrials out;
  ASSIGN_OR_RETURN(auto teaching, SourceOf(taught, folder, loaded, &out.set));
  out.set.taught_count = out.set.parts.size();
  out.trials.teaching = TrialsOf(std::move(teaching));
  out.trials.leave_one_out = leave_one_out;
  if (leave_one_out) {
    out.trials.queries = out.trials.teaching;
    return out;
  }
  ASSIGN_OR_RETURN(auto queries, SourceOf(queried, folder, loaded, &out.set));
  out.trials.queries = TrialsOf(std::move(queries));
  return out;
}

}  // namespace graspdb::lab
