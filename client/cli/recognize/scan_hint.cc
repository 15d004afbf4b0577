#include "client/cli/recognize/scan_hint.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "files/messages/cloud_message.h"
#include "files/messages/depth_message.h"
#include "files/messages/pose_message.h"
#include "recognition/points/median_point.h"

namespace graspdb::client {

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
