#include <google/protobuf/struct.pb.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/base/splits.h"
#include "client/cli/recognize/commands.h"
#include "client/cli/recognize/scan_source.h"
#include "client/cli/recognize/scoreboard.h"
#include "client/sdk/client.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "pictures/match_picture.h"
#include "recognition/points/median_point.h"
#include "recognition/segmentation/region.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::client {
namespace {

// Half the edge of the cut-out around the object, m.
constexpr double kCutOut = 0.16;

// Points lower than this are drawn as the table, m.
constexpr double kTableHeight = 0.005;

// The scan near the object, world frame.
recognition::Points CutOut(const recognition::Points& scan, const recognition::Pose& world_sensor,
                           const Eigen::Vector3d& center) {
  const recognition::Box box{center - Eigen::Vector3d::Constant(kCutOut),
                             center + Eigen::Vector3d::Constant(kCutOut)};
  return recognition::CropToRegion(scan, world_sensor, box).points;
}

std::string Caption(const ScanTask& task, const v1::RecognizeResponse& response,
                    const v1::Detection* detection) {
  if (detection == nullptr) {
    return absl::StrCat(task.path, ": ", v1::RecognitionStatus_Name(response.status()));
  }
  std::string caption = absl::StrFormat(
      "%s: %s  %s  score %.2f", task.path, detection->object().empty() ? "-" : detection->object(),
      v1::RecognitionStatus_Name(detection->status()), detection->score());
  const std::optional<Verdict> verdict = Judge(task, response);
  if (verdict && verdict->add_s_m) {
    absl::StrAppendFormat(&caption, "  ADD-S %.2f mm", *verdict->add_s_m * 1000);
  }
  return caption;
}

std::filesystem::path FileFor(const std::filesystem::path& folder, const ScanTask& task) {
  std::string name = std::filesystem::path(task.path).replace_extension("").string();
  for (char& c : name) {
    if (c == '/') c = '_';
  }
  return folder / (name + ".png");
}

// Writes `folder`/NAME.png for a scan and its response (the paper's figures 10 and
// 16): the scan white, the matched view green as found, shifted and refined, and
// the axes of the best grasp. Fetches the view's cloud from the server.
absl::Status WritePicture(Client& client, const std::filesystem::path& folder, const ScanTask& task,
                          const v1::RecognizeRequest& request,
                          const v1::RecognizeResponse& response) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return absl::FailedPreconditionError(
        absl::StrCat("cannot make the folder ", folder.string(), ": ", error.message()));
  }
  ASSIGN_OR_RETURN(recognition::Points scan, request.has_depth_image()
                                                 ? files::PointsFromMessage(request.depth_image())
                                                 : files::PointsFromMessage(request.cloud()));
  const v1::Detection* detection = MainDetection(task, response);
  pictures::MatchPicture picture;
  picture.caption = Caption(task, response, detection);
  picture.world_sensor = files::FromMessage(response.sensor_pose());
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  if (detection != nullptr) {
    center = {detection->centroid().x(), detection->centroid().y(), detection->centroid().z()};
  }
  picture.center = center;
  picture.scan = CutOut(scan, picture.world_sensor, center);
  if (response.world_frame_source() != v1::WORLD_FRAME_SOURCE_SENSOR) {
    const auto table = std::stable_partition(picture.scan.begin(), picture.scan.end(),
                                             [](const auto& p) { return p.z() > kTableHeight; });
    picture.table.assign(table, picture.scan.end());
    picture.scan.erase(table, picture.scan.end());
  }
  if (detection != nullptr && !detection->view().empty()) {
    ASSIGN_OR_RETURN(v1::View view, client.GetView(detection->view()));
    ASSIGN_OR_RETURN(recognition::Points points, files::PointsFromMessage(view.cloud()));
    const recognition::Pose world_object = files::FromMessage(view.object_pose());
    const recognition::Points found =
        recognition::Transform(files::FromMessage(view.sensor_pose()), points);
    const recognition::Points in_object = recognition::Transform(world_object.inverse(), found);
    picture.found = found;
    picture.shifted =
        recognition::Transform(files::FromMessage(detection->rough_pose()), in_object);
    picture.refined =
        recognition::Transform(files::FromMessage(detection->refined_pose()), in_object);
    if (!detection->grasps().empty()) {
      picture.world_tcp = files::FromMessage(detection->grasps(0).tcp_pose());
    }
  }
  return pictures::WriteMatchPicture(FileFor(folder, task), picture);
}

struct RecognizeOptions {
  std::vector<std::string> inputs;
  std::string split = "ALL";
  std::string cell;
  std::string pictures;
  bool segmented = false;
  bool stable = false;
};

constexpr char kRecognizeFooter[] =
    R"(A folder is a capture set; if its ground truth is known, the printed table has the pose
errors. Without a sensor pose (captures.json, the VIEWPOINT line or the cell) the world
frame is fitted to the table in front of the sensor.

With --json each scan prints one line {"path": ..., "response": ...}, or {"path": ...,
"error": ...} if the scan was rejected; the exit status is then 1. "hint" is there too
for each EMPTY_REGION and NO_CLUSTER, and for other scans without an object whose points lie
at an unusual place.

Examples:
  graspdb recognize scan.pcd
  graspdb recognize captures/monday --split QUERY --json | jq .response.status
  graspdb recognize captures/monday --split QUERY --pictures /tmp/pictures)";

// Protobuf's JSON printer quotes it.
std::string QuotedJson(const std::string& text) {
  google::protobuf::Value quoted;
  quoted.set_string_value(text);
  return ToJson(quoted).value_or("\"\"");
}

void PrintJsonLine(const std::string& path, const std::string& key, const std::string& json,
                   const std::string& hint = "") {
  std::printf("{\"path\":%s,\"%s\":%s%s%s}\n", QuotedJson(path).c_str(), key.c_str(), json.c_str(),
              hint.empty() ? "" : ",\"hint\":", hint.empty() ? "" : QuotedJson(hint).c_str());
}

std::string ErrorJson(const absl::Status& status) {
  google::protobuf::Struct error;
  (*error.mutable_fields())["code"].set_string_value(absl::StatusCodeToString(status.code()));
  (*error.mutable_fields())["message"].set_string_value(std::string(status.message()));
  return ToJson(error).value_or("{}");
}

// Recognises one scan and prints the response.
absl::Status RecognizeOne(Client& client, const GlobalOptions& global,
                          const RecognizeOptions& options, const ScanTask& task,
                          Scoreboard* board) {
  ASSIGN_OR_RETURN(v1::RecognizeRequest request, ReadScan(task));
  if (!options.cell.empty()) request.set_cell(ResourceName("cells", options.cell));
  if (options.segmented) request.set_segmented(true);
  request.set_omit_timings(options.stable);
  ASSIGN_OR_RETURN(v1::RecognizeResponse response, client.Recognize(request));
  const std::string hint = ScanHint(request, response);
  if (global.json) {
    ASSIGN_OR_RETURN(std::string json, ToJson(response));
    PrintJsonLine(task.path, "response", json, hint);
  } else {
    board->Add(task, response);
    if (!hint.empty()) std::printf("  %s\n", hint.c_str());
  }
  if (options.pictures.empty()) return absl::OkStatus();
  return WritePicture(client, options.pictures, task, request, response);
}

absl::Status RunRecognize(const GlobalOptions& global, const RecognizeOptions& options) {
  ASSIGN_OR_RETURN(ScanTasks scans, ListScans(options.inputs, options.split));
  Client client = Connect(global);
  Scoreboard board;
  if (!global.json) Scoreboard::PrintHeader();
  int failed = 0;
  absl::Status first_error;
  for (const ScanTask& task : scans.tasks) {
    if (!WriteOutput()) return absl::OkStatus();
    if (Interrupted()) return absl::CancelledError("interrupted");
    absl::Status status = RecognizeOne(client, global, options, task, &board);
    if (status.ok()) continue;
    if (absl::IsUnavailable(status)) return status;
    first_error.Update(status);
    ++failed;
    if (global.json) PrintJsonLine(task.path, "error", ErrorJson(status));
    if (scans.tasks.size() == 1) break;
    std::fprintf(stderr, "graspdb: %s: %s\n", task.path.c_str(),
                 std::string(status.message()).c_str());
  }
  std::fflush(stdout);
  if (!global.json) board.PrintSummary();
  if (failed == 0) return absl::OkStatus();
  if (scans.tasks.size() == 1) return first_error;
  return {first_error.code(), absl::StrCat(failed, " of ", scans.tasks.size(),
                                           " scans were refused; see the messages above")};
}

}  // namespace

void AddRecognizeCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command =
      AddCommand(app, "recognize", "Recognise the objects in scans, with poses and grasps");
  auto options = std::make_shared<RecognizeOptions>();
  command
      ->add_option("INPUT", options->inputs,
                   "Point files (.pcd, .ply), depth images (.png) or capture sets")
      ->required();
  AddSplitFlag(*command, &options->split);
  command->add_option("--cell", options->cell, "Cell with the calibration and settings to use");
  command->add_flag("--segmented", options->segmented,
                    "The scan has only the points of one object, no table");
  command->add_option("--pictures", options->pictures,
                      "Folder for one PNG per scan: found, shifted, refined");
  command->add_flag("--omit-timings", options->stable,
                    "Omit measured times: the same scan gives the same bytes");
  command->footer(kRecognizeFooter);
  command->callback(
      [=, &global] { *action = [=, &global] { return RunRecognize(global, *options); }; });
}

std::string ScanHint(const v1::RecognizeRequest& request, const v1::RecognizeResponse& response) {
  if (response.status() == v1::OK || response.status() == v1::NO_GRASP ||
      response.status() == v1::OUT_OF_WORKSPACE) {
    return "";
  }
  absl::StatusOr<recognition::Points> points = request.has_depth_image()
                                                   ? files::PointsFromMessage(request.depth_image())
                                                   : files::PointsFromMessage(request.cloud());
  if (!points.ok()) return "";
  recognition::Scan scan;
  scan.points = *std::move(points);
  const std::optional<Eigen::Vector3f> median = recognition::MedianPoint(scan);
  if (!median) return "";
  const bool is_empty =
      response.status() == v1::EMPTY_REGION || response.status() == v1::NO_CLUSTER;
  if (!is_empty && recognition::IsUsualDistance(*median)) return "";
  std::optional<recognition::Pose> world_sensor;
  if (response.has_sensor_pose()) world_sensor = files::FromMessage(response.sensor_pose());
  std::string out = recognition::WhereMedianIs(*median, world_sensor);
  if (is_empty) {
    absl::StrAppend(&out,
                    ". Check the region, and the sensor pose: of captures.json, the VIEWPOINT "
                    "line, or the cell");
  }
  return out;
}

}  // namespace graspdb::client
