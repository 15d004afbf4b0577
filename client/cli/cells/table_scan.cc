#include "client/cli/cells/table_scan.h"

#include <memory>
#include <utility>

#include "base/status_macros.h"
#include "client/cli/base/camera.h"
#include "files/points/point_file.h"

namespace graspdb::client {
namespace {

constexpr int kTableFrames = 5;
constexpr absl::Duration kSensorTimeout = absl::Seconds(10);

}  // namespace

absl::StatusOr<StillScan> FrameFrom(const std::filesystem::path& path) {
  ASSIGN_OR_RETURN(files::PointFile file, files::ReadPointFile(path));
  return StillScan{.points = std::move(file.points), .width = file.image_width()};
}

absl::StatusOr<StillScan> TableFrom(const std::string& frame, const std::string& sensor) {
  if (!frame.empty()) return FrameFrom(frame);
  ASSIGN_OR_RETURN(const std::unique_ptr<DepthSensor> camera, OpenCamera(sensor));
  const MonotonicTime deadline = MonotonicTime::Now() + kSensorTimeout;
  AwaitFrames(*camera, deadline);
  return TakeStillScan(*camera, kTableFrames, deadline);
}

}  // namespace graspdb::client
