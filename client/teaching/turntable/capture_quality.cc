#include "client/teaching/turntable/capture_quality.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cell/calibration/target/still_scan.h"

namespace graspdb::client {
namespace {

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

}  // namespace graspdb::client
