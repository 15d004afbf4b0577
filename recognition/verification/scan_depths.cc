#include "recognition/verification/scan_depths.h"

#include <algorithm>

#include "recognition/simd/kernels.h"

namespace graspdb::recognition {
namespace {

// How far around a segment its window reaches, m at the segment's distance.
constexpr float kWindowMarginM = 0.12F;
// Pixels to a side.
constexpr int kMaxPixelsPerSide = 2000;
// Pixels farther than this from the optical axis have no index.
constexpr float kFarthestPixel = 1e6F;

constexpr float kPitch = PixelWindow::kPitch;

// Keeps the nearest.
void PutBehind(float depth_m, float* known) {
  if (*known == 0 || -*known > depth_m) *known = -depth_m;
}

// A rectangle of an image; `high` is outside.
struct PixelRange {
  Eigen::Vector2i low;
  Eigen::Vector2i high;
};

// The pixels of an image that may lie in the window.
PixelRange PixelsIn(const CameraIntrinsics& camera, const PixelWindow& window) {
  const Eigen::Array2d focal(camera.fx, camera.fy);
  const Eigen::Array2d center(camera.cx, camera.cy);
  const Eigen::Array2d image(camera.width, camera.height);
  const auto at = [&](const Eigen::Vector2i& pixel) -> Eigen::Array2d {
    return static_cast<double>(kPitch) * pixel.cast<double>().array() * focal + center;
  };
  return {(at(window.low) - 1).max(0).min(image).cast<int>(),
          (at(window.high()) + 2).max(0).min(image).cast<int>()};
}

PixelWindow Union(const PixelWindow& a, const PixelWindow& b) {
  if (a.is_empty()) return b;
  if (b.is_empty()) return a;
  const Eigen::Vector2i low = a.low.cwiseMin(b.low);
  return {low, a.high().cwiseMax(b.high()) - low};
}

}  // namespace

Eigen::Vector2i PixelWindow::PixelOf(const Eigen::Vector3f& p) const {
  const Eigen::Array2f at = (p.head<2>().array() / p.z() - origin()) * (1 / kPitch);
  // Before the conversion to an integer, which may overflow; false for NaN.
  const bool inside = (at >= 0).all() && (at < size.cast<float>().array()).all();
  if (!inside) return {-1, -1};
  return at.cast<int>().matrix();
}

simd::DepthWindow PixelWindow::Of(const float* depths, std::size_t row) const {
  return {.depth = depths,
          .row = static_cast<std::ptrdiff_t>(row),
          .low = {origin().x(), origin().y()},
          .pixels_per_unit = 1 / kPitch,
          .size = {static_cast<float>(size.x()), static_cast<float>(size.y())}};
}

ScanDepths::ScanDepths(const Scan& scan, std::span<const Segment> segments) : scan_(scan) {
  PixelWindow all;
  // Segments that are too large are not searched.
  for (const Segment& segment : segments) {
    if (!segment.too_large) all = Union(all, WindowAround(segment));
  }
  if ((all.size.array() <= kMaxPixelsPerSide).all()) Fill(all);
}

PixelWindow ScanDepths::WindowAround(const Segment& segment) const {
  Eigen::Array2f low = Eigen::Array2f::Constant(1e9F);
  Eigen::Array2f high = -low;
  float depth = 1e9F;
  for (const std::int32_t i : segment.indices) {
    const Eigen::Vector3f p = scan_.PointAt(i);
    if (!IsMeasured(p)) continue;
    low = low.min(p.head<2>().array() / p.z());
    high = high.max(p.head<2>().array() / p.z());
    depth = std::min(depth, p.z());
  }
  if (depth >= 1e9F) return {};
  const auto pixel = [](const Eigen::Array2f& at) -> Eigen::Vector2i {
    return (at / kPitch).floor().max(-kFarthestPixel).min(kFarthestPixel).cast<int>();
  };
  PixelWindow out;
  out.low = pixel(low - kWindowMarginM / depth);
  out.size =
      (pixel(high + kWindowMarginM / depth) - out.low).array().min(kMaxPixelsPerSide - 1) + 1;
  return out;
}

void ScanDepths::Fill(const PixelWindow& window) {
  window_ = window;
  if (window.is_empty()) return;
  depths_.assign(
      static_cast<std::size_t>(window.size.x()) * static_cast<std::size_t>(window.size.y()), 0);
  if (scan_.is_image()) {
    PutImage(scan_.depth_image);
  } else {
    PutCloud(scan_.points);
  }
}

void ScanDepths::Copy(const PixelWindow& window, std::size_t begin, std::size_t row,
                      std::vector<float>* depths) const {
  if (!window_.Contains(window)) return ScanDepths(scan_, window).Copy(window, begin, row, depths);
  const Eigen::Vector2i from = window.low - window_.low;
  const auto own_row = static_cast<std::size_t>(window_.size.x());
  const float* source =
      &depths_[static_cast<std::size_t>(from.y()) * own_row + static_cast<std::size_t>(from.x())];
  float* target = &(*depths)[begin];
  for (int y = 0; y < window.size.y(); ++y, source += own_row, target += row) {
    std::copy_n(source, window.size.x(), target);
  }
}

void ScanDepths::PutImage(const DepthImage& image) {
  const PixelRange range = PixelsIn(image.camera, window_);
  if ((range.low.array() >= range.high.array()).any()) return;
  const auto first = static_cast<std::size_t>(range.low.x());
  simd::DepthRow row;
  row.width = static_cast<std::size_t>(range.high.x()) - first;
  row.unit = static_cast<float>(image.unit_m);
  std::vector<float> columns(row.width);
  for (std::size_t i = 0; i < row.width; ++i) columns[i] = ColumnOf(image.camera, first + i);
  row.column = columns.data();
  std::vector<std::int32_t> at(row.width);
  std::vector<float> depths(row.width);
  const auto window = window_.Of(depths_.data(), static_cast<std::size_t>(window_.size.x()));
  for (auto v = static_cast<std::size_t>(range.low.y());
       v < static_cast<std::size_t>(range.high.y()); ++v) {
    row.counts = &image.depth[v * static_cast<std::size_t>(image.camera.width) + first];
    row.row = RowOf(image.camera, v);
    simd::Best().locate(row, window, at.data(), depths.data());
    for (std::size_t i = 0; i < row.width; ++i) {
      if (at[i] >= 0) PutBehind(depths[i], &depths_[static_cast<std::size_t>(at[i])]);
    }
  }
}

void ScanDepths::PutCloud(const Points& points) {
  // A little more than the window, to leave most points out without dividing.
  const Eigen::Array2f low = window_.origin() - kPitch;
  const Eigen::Array2f high = window_.origin() + kPitch * (window_.size.cast<float>().array() + 1);
  for (const Eigen::Vector3f& p : points) {
    const bool is_near = p.x() > low.x() * p.z() && p.x() < high.x() * p.z() &&
                         p.y() > low.y() * p.z() && p.y() < high.y() * p.z();
    if (!is_near || !IsMeasured(p)) continue;
    const Eigen::Vector2i at = window_.PixelOf(p);
    if (at.x() < 0) continue;
    PutBehind(
        p.z(),
        &depths_[static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(window_.size.x()) +
                 static_cast<std::size_t>(at.x())]);
  }
}

}  // namespace graspdb::recognition
