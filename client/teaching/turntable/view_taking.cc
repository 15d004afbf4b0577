#include "client/teaching/turntable/view_taking.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/agent/jobs/cell_frames.h"
#include "client/cell/calibration/target/still_scan.h"
#include "client/teaching/upload/view_upload.h"
#include "files/messages/cloud_message.h"
#include "files/messages/depth_message.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::Pose;

absl::StatusOr<Pose> CameraOf(const v1::Cell& cell, const SensorFrame& frame) {
  ASSIGN_OR_RETURN(const CellFrames frames, FramesOf(cell));
  if (frames.flange_sensor) {
    return absl::FailedPreconditionError(absl::StrCat(
        "the camera of ", cell.name(),
        " is on the robot; drive it to the teaching position, create a cell for that position with "
        "`graspdb cells level`, and give it as --cell"));
  }
  return WorldSensor(frames, std::nullopt, frame.world_sensor);
}

Vector3d CenterOf(const recognition::Points& points, const Pose& world_sensor) {
  Vector3d sum = Vector3d::Zero();
  for (const Eigen::Vector3f& p : points) sum += p.cast<double>();
  return world_sensor * (sum / static_cast<double>(points.size()));
}

// The mean of depth images is a finer depth image.
files::ScanMessage MessageOf(const StillScan& scan) {
  if (!scan.camera) return files::CloudMessage(scan.points, scan.width);
  std::vector<float> depths;
  depths.reserve(scan.points.size());
  float far = 0;
  for (const Eigen::Vector3f& p : scan.points) {
    depths.push_back(p.z());
    far = std::max(far, p.z());  // keeps `far` where p is NaN
  }
  return files::FineDepthMessage(depths, *scan.camera, static_cast<double>(far));
}

}  // namespace

// Frames of one moment, with the pose of the camera.
struct ViewTaker::Shot {
  std::vector<SensorFrame> frames;
  Pose world_sensor = Pose::Identity();
};

absl::StatusOr<ViewTaker::Shot> ViewTaker::Shoot(int frames) {
  const MonotonicTime deadline = MonotonicTime::Now() + how_.frame_timeout;
  AwaitFrames(sensor_, deadline);
  ASSIGN_OR_RETURN(std::vector<SensorFrame> taken, TakeFrames(sensor_, frames, deadline));
  Shot shot;
  shot.frames = std::move(taken);
  ASSIGN_OR_RETURN(shot.world_sensor, CameraOf(how_.cell, shot.frames.front()));
  shot.world_sensor.translation().z() -= how_.plate_height_m;
  return shot;
}

absl::Status ViewTaker::Check() { return Shoot(1).status(); }

absl::StatusOr<TakenView> ViewTaker::InspectTaught(const std::string& name, const Shot& shot) {
  ASSIGN_OR_RETURN(const v1::View view, client_.GetView(name));
  ASSIGN_OR_RETURN(const recognition::Points object, files::PointsFromMessage(view.cloud()));
  ASSIGN_OR_RETURN(const CaptureQuality quality, CaptureQualityOf(shot.frames, object));
  return TakenView{.view = {.name = name, .point_count = view.point_count()},
                   .quality = quality,
                   .center = CenterOf(object, shot.world_sensor)};
}

absl::StatusOr<TakenView> ViewTaker::Take(const std::string& stable_pose,
                                          const Pose& world_object) {
  ASSIGN_OR_RETURN(const Shot shot, Shoot(how_.frames));
  ASSIGN_OR_RETURN(const StillScan scan, Averaged(shot.frames));
  v1::UploadViewsRequest upload;
  upload.set_parent(stable_pose);
  files::SetScan(MessageOf(scan), upload.mutable_view());
  *upload.mutable_view()->mutable_object_pose() = files::ToMessage(world_object);
  *upload.mutable_view()->mutable_sensor_pose() = files::ToMessage(shot.world_sensor);
  if (how_.region) *upload.mutable_region_of_interest() = *how_.region;
  upload.set_view_id(files::ContentId(upload.view()));
  const std::string name = absl::StrCat(stable_pose, "/views/", upload.view_id());
  const auto make = [&](std::size_t, v1::UploadViewsRequest* request) {
    *request = upload;
    return absl::OkStatus();
  };
  ASSIGN_OR_RETURN(const auto counts, TeachViews(client_, {.count = 1, .make = make}, {}));
  if (counts.created == 0) {
    return absl::AlreadyExistsError(
        "this frame is already taught; turn the object, and check that the camera is not frozen");
  }
  absl::StatusOr<TakenView> taken = InspectTaught(name, shot);
  if (taken.ok()) return taken;
  // After an error the view is taken again, and would exist twice.
  const absl::Status gone = client_.DeleteView(name);
  if (gone.ok() || absl::IsNotFound(gone)) return taken;
  return absl::Status(
      taken.status().code(),
      absl::StrCat(std::string(taken.status().message()), "; ", name,
                   " is taught nevertheless and cannot be deleted: ", std::string(gone.message())));
}

}  // namespace graspdb::client
