#include "client/cell/calibration/target/still_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/status/status.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "files/messages/scan_message.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3f;

constexpr absl::Duration kPause = absl::Milliseconds(20);  // between checks of IsReady

bool IsMeasured(const Vector3f& p) { return p.allFinite() && p.z() > 0; }

bool AreAligned(std::span<const StillScan> scans) {
  return std::ranges::all_of(scans, [&](const StillScan& scan) {
    return scan.width > 0 && scan.width == scans.front().width &&
           scan.points.size() == scans.front().points.size();
  });
}

// The point of one pixel, on its ray. `depths` is a scratch buffer.
Vector3f MeanNearMedian(std::span<const StillScan> scans, std::size_t pixel,
                        std::vector<float>* depths) {
  Vector3f ray = Vector3f::Zero();
  depths->clear();
  for (const StillScan& scan : scans) {
    const Vector3f& p = scan.points[pixel];
    if (!IsMeasured(p)) continue;
    depths->push_back(p.z());
    ray = p / p.z();
  }
  if (depths->empty() || 2 * depths->size() < scans.size()) {
    return Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  }
  const auto middle = depths->begin() + static_cast<std::ptrdiff_t>(depths->size() / 2);
  std::ranges::nth_element(*depths, middle);
  const float median = *middle;
  float sum = 0;
  float count = 0;
  for (const float depth : *depths) {
    if (std::abs(depth - median) > kSameSurfaceShare * median) continue;
    sum += depth;
    ++count;
  }
  return sum / count * ray;
}

}  // namespace

absl::StatusOr<StillScan> ScanOf(const SensorFrame& frame) {
  ASSIGN_OR_RETURN(
      recognition::Points points,
      std::visit([](const auto& scan) { return files::PointsFromMessage(scan); }, frame.scan));
  if (const auto* cloud = std::get_if<v1::PointCloud>(&frame.scan)) {
    return StillScan{.points = std::move(points), .width = cloud->width()};
  }
  const auto camera = files::FromMessage(std::get<v1::DepthImage>(frame.scan).intrinsics());
  return StillScan{.points = std::move(points), .width = camera.width, .camera = camera};
}

absl::StatusOr<StillScan> Averaged(std::span<const SensorFrame> frames) {
  if (frames.empty()) return absl::InvalidArgumentError("there is no frame; take at least one");
  std::vector<StillScan> scans;
  scans.reserve(frames.size());
  for (const SensorFrame& frame : frames) {
    ASSIGN_OR_RETURN(StillScan scan, ScanOf(frame));
    scans.push_back(std::move(scan));
  }
  if (scans.size() == 1 || !AreAligned(scans)) return std::move(scans.back());
  StillScan out{.points = {}, .width = scans.front().width, .camera = scans.front().camera};
  out.points.reserve(scans.front().points.size());
  std::vector<float> depths;
  for (std::size_t i = 0; i < scans.front().points.size(); ++i) {
    out.points.push_back(MeanNearMedian(scans, i, &depths));
  }
  return out;
}

void AwaitFrames(DepthSensor& sensor, MonotonicTime deadline) {
  while (!sensor.IsReady() && MonotonicTime::Now() < deadline) absl::SleepFor(kPause);
}

absl::StatusOr<std::vector<SensorFrame>> TakeFrames(DepthSensor& sensor, int count,
                                                    MonotonicTime deadline) {
  std::vector<SensorFrame> frames;
  for (int i = 0; i < count; ++i) {
    ASSIGN_OR_RETURN(SensorFrame frame, sensor.Next(deadline));
    frames.push_back(std::move(frame));
  }
  return frames;
}

absl::StatusOr<StillScan> TakeStillScan(DepthSensor& sensor, int count, MonotonicTime deadline) {
  ASSIGN_OR_RETURN(const std::vector<SensorFrame> frames, TakeFrames(sensor, count, deadline));
  return Averaged(frames);
}

}  // namespace graspdb::client
