#include "client/cli/cells/table_scan.h"

#include <memory>
#include <utility>

#include "client/cli/base/camera.h"
#include "files/point_file.h"

namespace graspdb::client {
namespace {

constexpr int kTableFrames = 5;
constexpr absl::Duration kSensorTimeout = absl::Seconds(10);

}  // namespace

absl::StatusOr<StillScan> FrameFrom(const std::filesystem::path& path) {
  absl::StatusOr<files::PointFile> file = files::ReadPointFile(path);
  if (!file.ok()) return file.status();
  return StillScan{.points = std::move(file->points), .width = file->image_width()};
}

absl::StatusOr<StillScan> TableFrom(const std::string& frame, const std::string& sensor) {
  if (!frame.empty()) return FrameFrom(frame);
  const absl::StatusOr<std::unique_ptr<DepthSensor>> camera = OpenCamera(sensor);
  if (!camera.ok()) return camera.status();
  const MonotonicTime deadline = MonotonicTime::Now() + kSensorTimeout;
  AwaitFrames(**camera, deadline);
  return TakeStillScan(**camera, kTableFrames, deadline);
}

}  // namespace graspdb::client
