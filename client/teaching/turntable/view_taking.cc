#include "client/teaching/turntable/view_taking.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cell/agent/jobs/cell_frames.h"
#include "client/cell/calibration/target/still_scan.h"
#include "client/teaching/upload/view_upload.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::Pose;

// Pixels of the object, row by row.
using Rows = std::map<int, std::set<int>>;

Rows PixelsOf(const recognition::Points& object, const v1::CameraIntrinsics& camera) {
  Rows rows;
  for (const Eigen::Vector3f& p : object) {
    if (!(p.z() > 0)) continue;
    const auto column = static_cast<int>(std::lround(camera.fx() * p.x() / p.z() + camera.cx()));
    const auto row = static_cast<int>(std::lround(camera.fy() * p.y() / p.z() + camera.cy()));
    if (column < 0 || column >= camera.width() || row < 0 || row >= camera.height()) continue;
    rows[row].insert(column);
  }
  return rows;
}

class Frames {
 public:
  static absl::StatusOr<Frames> Read(std::span<const SensorFrame> frames) {
    Frames out;
    for (const SensorFrame& frame : frames) {
      ASSIGN_OR_RETURN(StillScan scan, ScanOf(frame));
      if (scan.width != out.width() && !out.scans_.empty()) continue;
      out.scans_.push_back(std::move(scan));
    }
    return out;
  }

  // The depths measured at a pixel, m.
  std::vector<float> Depths(int row, int column) const {
    std::vector<float> out;
    const std::size_t pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(width()) +
                              static_cast<std::size_t>(column);
    for (const StillScan& scan : scans_) {
      if (pixel < scan.points.size() && scan.points[pixel].z() > 0) {
        out.push_back(scan.points[pixel].z());
      }
    }
    return out;
  }

 private:
  int width() const { return scans_.empty() ? 0 : scans_.front().width; }
  std::vector<StillScan> scans_;
};

double MeasuredShare(const Frames& frames, const Rows& rows) {
  int measured = 0;
  int all = 0;
  for (const auto& [row, columns] : rows) {
    for (int column = *columns.begin(); column <= *columns.rbegin(); ++column) {
      ++all;
      if (!frames.Depths(row, column).empty()) ++measured;
    }
  }
  return all == 0 ? 1 : static_cast<double>(measured) / all;
}

double DeviationOf(const std::vector<float>& depths) {
  double mean = 0;
  for (const float depth : depths) mean += depth;
  mean /= static_cast<double>(depths.size());
  double sum = 0;
  for (const float depth : depths) sum += (depth - mean) * (depth - mean);
  return std::sqrt(sum / static_cast<double>(depths.size() - 1));
}

void CompareFrames(const Frames& frames, const Rows& rows, CaptureQuality* out) {
  std::vector<double> deviations;
  int moving = 0;
  for (const auto& [row, columns] : rows) {
    for (const int column : columns) {
      const std::vector<float> depths = frames.Depths(row, column);
      if (depths.size() < 2) continue;
      const auto [nearest, farthest] = std::ranges::minmax(depths);
      if (farthest - nearest > kSameSurfaceShare * nearest) ++moving;
      deviations.push_back(DeviationOf(depths));
    }
  }
  if (deviations.empty()) return;
  out->moving_share = static_cast<double>(moving) / static_cast<double>(deviations.size());
  const auto middle = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2);
  std::ranges::nth_element(deviations, middle);
  out->noise_m = *middle;
}

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

absl::StatusOr<CaptureQuality> CaptureQualityOf(std::span<const SensorFrame> frames,
                                                const recognition::Points& object) {
  if (frames.empty()) return absl::InvalidArgumentError("there is no frame; take at least one");
  CaptureQuality out{.point_count = static_cast<int>(object.size())};
  const auto* image = std::get_if<v1::DepthImage>(&frames.front().scan);
  if (image == nullptr) return out;
  ASSIGN_OR_RETURN(const Frames read, Frames::Read(frames));
  const Rows rows = PixelsOf(object, image->intrinsics());
  out.of_image = true;
  out.measured_share = MeasuredShare(read, rows);
  CompareFrames(read, rows, &out);
  return out;
}

std::string CaptureQualityText(const CaptureQuality& quality) {
  std::string out = absl::StrFormat("%d points", quality.point_count);
  if (!quality.of_image) return out;
  absl::StrAppendFormat(&out, ", %.0f %% of its outline measured", 100 * quality.measured_share);
  if (quality.noise_m > 0) {
    absl::StrAppendFormat(&out, ", depths within %.1f mm", 1000 * quality.noise_m);
  }
  return out;
}

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
