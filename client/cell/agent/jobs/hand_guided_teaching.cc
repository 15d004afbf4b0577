#include "client/cell/agent/jobs/hand_guided_teaching.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/agent/jobs/capture_and_recognize.h"
#include "files/messages/pose_message.h"

namespace graspdb::client {
namespace {

using recognition::Pose;

constexpr double kMaxToolDistanceM = 0.3;
constexpr double kBelowTableM = 0.001;
constexpr absl::Duration kSceneMemory = absl::Minutes(10);

const v1::Detection* NearestObject(const JobConfig& job, const SeenScene& scene,
                                   const Eigen::Vector3d& world_tcp) {
  const v1::Detection* nearest = nullptr;
  double min_distance = kMaxToolDistanceM;
  for (const v1::Detection& detection : scene.answer.detections()) {
    const bool is_known = detection.status() == v1::OK || detection.status() == v1::NO_GRASP ||
                          detection.status() == v1::OUT_OF_WORKSPACE;
    if (!is_known || (!job.object.empty() && detection.object() != job.object)) continue;
    const v1::Vector3& c = detection.centroid();
    const double distance = (Eigen::Vector3d(c.x(), c.y(), c.z()) - world_tcp).norm();
    if (distance > min_distance) continue;
    min_distance = distance;
    nearest = &detection;
  }
  return nearest;
}

absl::Status CheckAboveTable(const Pose& object_tcp, double approach_distance_m) {
  const double tcp = object_tcp.translation().z();
  const double before = tcp - approach_distance_m * object_tcp.linear()(2, 2);
  if (tcp >= -kBelowTableM && before >= -kBelowTableM) return absl::OkStatus();
  return absl::OutOfRangeError(absl::StrCat(
      "the tool would go ", 1000 * -std::min(tcp, before),
      " mm below the table; does the tool's z axis point in the direction of approach, and is the "
      "cell calibrated?"));
}

}  // namespace

std::shared_ptr<const SeenScene> RecallScene(const RobotSession& session) {
  auto scene = std::dynamic_pointer_cast<const SeenScene>(session.scene());
  if (scene != nullptr && MonotonicTime::Now() - scene->time > kSceneMemory) scene = nullptr;
  return scene;
}

absl::Status StoreShownGrasp(Client& client, const JobConfig& job, const SeenScene& scene,
                             const Pose& base_tcp) {
  const Pose world_tcp = scene.frames.world_base * base_tcp;
  const v1::Detection* object = NearestObject(job, scene, world_tcp.translation());
  if (object == nullptr) {
    return absl::NotFoundError(absl::StrCat(
        "nothing ", job.object.empty() ? "known" : "of " + job.object,
        " was found within 0.3 m of the tool; run a recognising job before the robot covers it"));
  }
  const Pose object_tcp = files::FromMessage(object->refined_pose()).inverse() * world_tcp;
  RETURN_IF_ERROR(CheckAboveTable(object_tcp, job.shown_grasp.approach_distance_m()));
  absl::StatusOr<v1::StablePose> pose = client.GetStablePose(object->stable_pose());
  if (!pose.ok()) return Refusal(pose.status());
  v1::UpdateStablePoseRequest update;
  *update.mutable_stable_pose() = *pose;  // with its etag, so that no concurrent change is lost
  v1::Grasp shown = job.shown_grasp;
  *shown.mutable_tcp_pose() = files::ToMessage(object_tcp);
  auto* grasps = update.mutable_stable_pose()->mutable_grasps();
  const auto existing = std::ranges::find(*grasps, shown.grasp_id(), &v1::Grasp::grasp_id);
  (existing == grasps->end() ? *grasps->Add() : *existing) = shown;
  update.mutable_update_mask()->add_paths("grasps");
  absl::Status stored = Refusal(client.UpdateStablePose(update).status());
  if (stored.ok()) {
    spdlog::info("event=grasp_shown stable_pose={} grasp={}", object->stable_pose(),
                 shown.grasp_id());
  }
  return stored;
}

}  // namespace graspdb::client
