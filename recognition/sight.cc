#include "recognition/sight.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "recognition/wide.h"

namespace graspdb::recognition {
namespace {

// Angle of a pixel, rad: coarser than a Kinect's, so that a surface leaves no holes; 3 mm at
// 0.85 m.
constexpr float kPitch = 0.0035F;
// How far around the segment the window reaches, m at the segment's distance.
constexpr float kMarginM = 0.12F;
constexpr int kLargestSide = 2000;
constexpr float kPerPitch = 1 / kPitch;
// What stands before an edge of the segment is at most so many pixels from it, and nearer by this.
constexpr int kEdgePixels = 3;
constexpr float kBeforeM = 0.02F;
// Share of all the segment's edges that must be cut off for a side to be hidden.
constexpr double kCutShare = 0.04;

// No depth camera measures nearer, m: such a point is nearly beside the lens, and one of them would
// make the window as wide as it can be.
constexpr float kNearestM = 0.01F;

bool IsMeasured(const Eigen::Vector3f& p) { return p.allFinite() && p.z() > kNearestM; }

// What is measured beside a segment: the nearest is seen.
void PutBehind(float depth_m, float* known) {
  if (*known == 0 || -*known > depth_m) *known = -depth_m;
}

// A rectangle of an image; `high` is outside.
struct PixelRange {
  Eigen::Vector2i low;
  Eigen::Vector2i high;
};

// The pixels of an image that may lie in the window.
PixelRange PixelsIn(const CameraIntrinsics& camera, const Eigen::Vector2f& low,
                    const Eigen::Vector2i& size) {
  const Eigen::Array2d focal(camera.fx, camera.fy);
  const Eigen::Array2d center(camera.cx, camera.cy);
  const Eigen::Array2d image(camera.width, camera.height);
  const Eigen::Array2d first = low.cast<double>().array() * focal + center;
  const Eigen::Array2d last =
      (low + kPitch * size.cast<float>()).cast<double>().array() * focal + center;
  return {(first - 1).max(0).min(image).cast<int>(), (last + 2).max(0).min(image).cast<int>()};
}

}  // namespace

Sight::Sight(const Scan& scan, const Pose& world_sensor, const Segment& segment)
    : sensor_world_(world_sensor.inverse().cast<float>()), alone_(scan.segmented) {
  if (segment.indices.empty()) return;
  Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9F);
  Eigen::Vector2f high = -low;
  float depth = 1e9F;
  for (const std::int32_t i : segment.indices) {
    const Eigen::Vector3f p = scan.PointAt(i);
    if (!IsMeasured(p)) continue;
    low = low.cwiseMin(p.head<2>() / p.z());
    high = high.cwiseMax(p.head<2>() / p.z());
    depth = std::min(depth, p.z());
  }
  if (depth >= 1e9F) return;
  low_ = low.array() - kMarginM / depth;
  size_ = ((high - low).array() + 2 * kMarginM / depth)
              .matrix()
              .cwiseQuotient(Eigen::Vector2f::Constant(kPitch))
              .cwiseMin(static_cast<float>(kLargestSide))
              .cast<int>()
              .array() +
          1;
  constexpr std::size_t kBorders = std::size_t{2} * kBorder;
  row_ = static_cast<std::size_t>(size_.x()) + kBorders;
  depths_.assign(row_ * (static_cast<std::size_t>(size_.y()) + kBorders), 0);
  if (scan.is_image()) {
    PutImage(scan.depth_image);
  } else {
    PutCloud(scan.points);
  }
  for (const std::int32_t i : segment.indices) {
    const Eigen::Vector3f p = scan.PointAt(i);
    if (!IsMeasured(p)) continue;
    const Eigen::Vector2i at = Project(p);
    if (IsInside(at)) depths_[PlaceOf(at)] = p.z();
  }
}

void Sight::PutImage(const DepthImage& image) {
  const PixelRange range = PixelsIn(image.camera, low_, size_);
  if ((range.low.array() >= range.high.array()).any()) return;
  const auto first = static_cast<std::size_t>(range.low.x());
  wide::DepthRow row;
  row.width = static_cast<std::size_t>(range.high.x()) - first;
  row.unit = static_cast<float>(image.unit_m);
  std::vector<float> columns(row.width);
  for (std::size_t i = 0; i < row.width; ++i) columns[i] = ColumnOf(image.camera, first + i);
  row.column = columns.data();
  std::vector<std::int32_t> at(row.width);
  std::vector<float> depths(row.width);
  const std::size_t origin = PlaceOf({0, 0});
  for (auto v = static_cast<std::size_t>(range.low.y());
       v < static_cast<std::size_t>(range.high.y()); ++v) {
    row.counts = &image.depth[v * static_cast<std::size_t>(image.camera.width) + first];
    row.row = RowOf(image.camera, v);
    wide::Best().locate(row, window(), at.data(), depths.data());
    for (std::size_t i = 0; i < row.width; ++i) {
      if (at[i] >= 0) PutBehind(depths[i], &depths_[origin + static_cast<std::size_t>(at[i])]);
    }
  }
}

void Sight::PutCloud(const Points& points) {
  // A little more than the window, to leave most points out without dividing.
  const Eigen::Array2f low = low_.array() - kPitch;
  const Eigen::Array2f high = low_.array() + kPitch * (size_.cast<float>().array() + 1);
  for (const Eigen::Vector3f& p : points) {
    const bool is_near = p.x() > low.x() * p.z() && p.x() < high.x() * p.z() &&
                         p.y() > low.y() * p.z() && p.y() < high.y() * p.z();
    if (!is_near || !IsMeasured(p)) continue;
    const Eigen::Vector2i at = Project(p);
    if (IsInside(at)) PutBehind(p.z(), &depths_[PlaceOf(at)]);
  }
}

bool Sight::IsCut(const Eigen::Vector2i& at, const Eigen::Vector2i& step,
                  bool unmeasured_too) const {
  static_assert(kEdgePixels <= kBorder);
  bool is_measured = false;
  for (int reach = 1; reach <= kEdgePixels; ++reach) {
    const float beyond = DepthAt(at + reach * step);
    if (beyond == 0) continue;
    is_measured = true;
    if (beyond < 0 && -beyond < DepthAt(at) - kBeforeM) return true;
  }
  return unmeasured_too && !is_measured;
}

Sight::Sides Sight::SidesWhere(bool unmeasured_too) const {
  std::array<int, 4> cut = {};  // right, left, bottom, top
  int ends = 0;                 // of rows and columns of the segment
  for (int y = 0; y < size_.y(); ++y) {
    for (int x = 0; x < size_.x(); ++x) {
      const Eigen::Vector2i at(x, y);
      if (DepthAt(at) <= 0) continue;
      for (int side = 0; side < 4; ++side) {
        const Eigen::Vector2i step(side == 0 ? 1 : (side == 1 ? -1 : 0),
                                   side == 2 ? 1 : (side == 3 ? -1 : 0));
        if (DepthAt(at + step) > 0) continue;
        ++ends;
        cut[static_cast<std::size_t>(side)] += IsCut(at, step, unmeasured_too);
      }
    }
  }
  const auto is_cut = [&](int side) {
    return cut[static_cast<std::size_t>(side)] > kCutShare * ends;
  };
  return {.left = is_cut(1), .right = is_cut(0), .top = is_cut(3), .bottom = is_cut(2)};
}

Eigen::Vector2i Sight::Project(const Eigen::Vector3f& p) const {
  const Eigen::Array2f at = (p.head<2>() / p.z() - low_).array() * kPerPitch;
  // Before it becomes an integer, which may have no room for it; false for what is not a number.
  const bool near = (at >= -1).all() && (at < size_.cast<float>().array() + 1).all();
  if (!near) return {-2, -2};
  return at.floor().cast<int>().matrix();
}

wide::SightWindow Sight::window() const {
  if (depths_.empty()) return {};
  return {.depth = &depths_[PlaceOf({0, 0})],
          .row = static_cast<std::ptrdiff_t>(row_),
          .low = {low_.x(), low_.y()},
          .pixels_per_unit = kPerPitch,
          .size = {static_cast<float>(size_.x()), static_cast<float>(size_.y())},
          .alone = alone_};
}

}  // namespace graspdb::recognition
