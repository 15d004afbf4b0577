#include "client/cell/calibration/target/target.h"

#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cell/calibration/target/gripped_target.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "recognition/segmentation/region.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::client {
namespace {

using recognition::Box;
using recognition::Points;
using recognition::Pose;

// Maximum deviation between fused views, m; beyond it they were taught without object poses.
constexpr float kMaxFusedDeviationM = 0.004F;
// Detections closer than this, m, belong to one object.
constexpr double kApartM = 0.05;
// Crop of a target on the table: margin around it, and minimum height above the table, m.
constexpr double kCropMarginM = 0.03;
constexpr double kStandsAboveM = 0.006;
// If the refinement confirms less than this share of the surface, the server's pose is kept.
constexpr double kRefinedSeen = 0.75;
// Default region of a gripped target: above the table, to exclude its plane, and around the world's
// origin.
constexpr double kAboveTableM = 0.02;
constexpr double kMaxHeightM = 1.0;
constexpr double kAroundM = 1.0;

absl::StatusOr<std::string> StablePoseNamed(Client& client, const std::string& name) {
  if (absl::StrContains(name, "/stablePoses/")) return name;
  const absl::StatusOr<std::vector<v1::StablePose>> poses = client.ListStablePoses(name);
  if (absl::IsNotFound(poses.status())) {
    return absl::FailedPreconditionError(
        absl::StrCat("the target ", name, " is not in the catalogue; teach it first"));
  }
  if (!poses.ok()) return poses.status();
  if (poses->size() == 1) return poses->front().name();
  return absl::FailedPreconditionError(absl::StrCat("the target ", name, " has ", poses->size(),
                                                    " stable poses; specify one: ", name,
                                                    "/stablePoses/..."));
}

absl::Status RefuseSymmetry(Client& client, const std::string& stable_pose) {
  const auto symmetric = [&](int order) {
    return absl::FailedPreconditionError(absl::StrCat(
        stable_pose, " looks the same after a turn about the vertical (symmetry ", order,
        ", 0: any turn), so its heading is undetermined; use a target without symmetry"));
  };
  const absl::StatusOr<v1::StablePose> declared = client.GetStablePose(stable_pose);
  if (absl::IsNotFound(declared.status())) {
    return absl::FailedPreconditionError(
        absl::StrCat(stable_pose, " is not in the catalogue; teach it first"));
  }
  if (!declared.ok()) return declared.status();
  if (declared->has_symmetry_order() && declared->symmetry_order() != 1) {
    return symmetric(declared->symmetry_order());
  }
  const std::string object = stable_pose.substr(0, stable_pose.find("/stablePoses/"));
  ASSIGN_OR_RETURN(const auto alike, client.FindLookAlikes(object));
  for (const v1::StablePoseSymmetry& found : alike.symmetries()) {
    if (found.stable_pose() == stable_pose && found.found_order() != 1) {
      return symmetric(found.found_order());
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<recognition::PosedCloud> CloudOf(Client& client, const std::string& view_name) {
  ASSIGN_OR_RETURN(const v1::View view, client.GetView(view_name));
  ASSIGN_OR_RETURN(const Points points, files::PointsFromMessage(view.cloud()));
  const Pose world_sensor = files::FromMessage(view.sensor_pose());
  auto cloud = std::make_shared<recognition::OrientedCloud>(
      recognition::PrepareCloud(recognition::Transform(world_sensor, points),
                                world_sensor.translation(), recognition::DescriptorParameters()));
  return recognition::PosedCloud{std::move(cloud), files::FromMessage(view.object_pose())};
}

// Whether `detection` is the target, at an unambiguous pose.
bool IsUnambiguous(const v1::Detection& detection, const std::string& stable_pose) {
  if (detection.stable_pose() != stable_pose) return false;
  return detection.status() != v1::AMBIGUOUS || detection.equivalent_poses().empty();
}

// Points in the sensor frame.
Points PointsIn(const Box& world_box, const StillScan& scan, const Pose& world_sensor) {
  Points out;
  for (const std::int32_t i :
       recognition::CropToRegion(scan.points, world_sensor, world_box).indices) {
    out.push_back(scan.points[static_cast<std::size_t>(i)]);
  }
  return out;
}

bool IsApart(const v1::Detection& a, const v1::Detection& b) {
  const Pose between =
      files::FromMessage(a.refined_pose()).inverse() * files::FromMessage(b.refined_pose());
  return between.translation().norm() > kApartM;
}

// Refines the pose on the target's points above the table.
DetectedTarget RefineStanding(const Target& target, const StillScan& scan, const Pose& world_sensor,
                              const Pose& world_target) {
  const Eigen::Vector3d center = world_target * target.model->center.cast<double>();
  const Eigen::Vector3d reach =
      Eigen::Vector3d::Constant(static_cast<double>(target.model->radius_m) + kCropMarginM);
  Box around{center - reach, center + reach};
  around.min.z() = kStandsAboveM;
  const Points points = PointsIn(around, scan, world_sensor);
  const TargetScan on_table(points, scan.points, world_sensor, /*on_table=*/true);
  const TargetFit fit = on_table.Refine(*target.model, world_target);
  const Pose sensor_target =
      world_sensor.inverse() * (fit.seen >= kRefinedSeen ? fit.world_target : world_target);
  return {sensor_target, CovarianceOf(*target.model, points, sensor_target, /*on_table=*/true)};
}

}  // namespace

absl::StatusOr<Target> LoadTarget(Client& client, const std::string& name) {
  ASSIGN_OR_RETURN(std::string stable_pose, StablePoseNamed(client, name));
  RETURN_IF_ERROR(RefuseSymmetry(client, stable_pose));
  ASSIGN_OR_RETURN(const std::vector<v1::View> views, client.ListViews(stable_pose));
  std::vector<recognition::PosedCloud> clouds;
  clouds.reserve(views.size());
  for (const v1::View& view : views) {
    ASSIGN_OR_RETURN(recognition::PosedCloud cloud, CloudOf(client, view.name()));
    clouds.push_back(std::move(cloud));
  }
  Target out{.stable_pose = std::move(stable_pose), .model = recognition::FuseViews(clouds)};
  if (out.model == nullptr || out.model->deviation_m > kMaxFusedDeviationM) {
    return absl::FailedPreconditionError(absl::StrCat(
        out.stable_pose, " has ", views.size(),
        " views, and they do not form one shape; teach it from all around with its object poses"));
  }
  return out;
}

absl::StatusOr<DetectedTarget> FindTargetOnTable(Client& client, const Target& target,
                                                 const StillScan& scan) {
  v1::RecognizeRequest request;
  *request.mutable_cloud() = files::CloudMessage(scan.points, scan.width);
  const absl::StatusOr<v1::RecognizeResponse> response = client.Recognize(request);
  if (absl::IsFailedPrecondition(response.status())) {
    return absl::NotFoundError(
        "the camera sees no table under the target; look down at it from a shorter distance");
  }
  if (!response.ok()) return response.status();
  const v1::Detection* found = nullptr;
  for (const v1::Detection& detection : response->detections()) {
    if (!IsUnambiguous(detection, target.stable_pose)) continue;
    if (found != nullptr && IsApart(*found, detection)) {
      return absl::NotFoundError(
          absl::StrCat(target.stable_pose, " is detected more than once; leave one on the table"));
    }
    // Several parts of one object: the largest is the most reliable.
    if (found == nullptr || detection.point_count() > found->point_count()) found = &detection;
  }
  if (found == nullptr) {
    return absl::NotFoundError(
        absl::StrCat(target.stable_pose, " is not recognised among ", response->detections_size(),
                     " visible objects; view it from the taught directions"));
  }
  return RefineStanding(target, scan, files::FromMessage(response->sensor_pose()),
                        files::FromMessage(found->refined_pose()));
}

absl::StatusOr<DetectedTarget> FindGrippedTarget(const Target& target, const StillScan& scan,
                                                 const Pose& world_sensor,
                                                 const std::optional<Box>& region) {
  const Box around =
      region.value_or(Box{{-kAroundM, -kAroundM, kAboveTableM}, {kAroundM, kAroundM, kMaxHeightM}});
  const Points points = PointsIn(around, scan, world_sensor);
  const TargetScan gripped(points, scan.points, Pose::Identity(), /*on_table=*/false);
  if (const std::optional<TargetFit> found = FindGrippedTarget(*target.model, gripped)) {
    return DetectedTarget{found->world_target,
                          CovarianceOf(*target.model, points, found->world_target,
                                       /*on_table=*/false)};
  }
  return absl::NotFoundError(absl::StrFormat(
      "%s is not recognised among the %d points of the gripper's region; turn it so that the "
      "camera sees most of it, from a taught direction",
      target.stable_pose, points.size()));
}

}  // namespace graspdb::client
