#include "client/cli/recognize/picture_writer.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/recognize/scoreboard.h"
#include "files/messages/cloud_message.h"
#include "files/messages/depth_message.h"
#include "files/messages/pose_message.h"
#include "pictures/match_picture.h"
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

}  // namespace

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

}  // namespace graspdb::client
