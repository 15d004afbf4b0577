#include "recognition/sight.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace graspdb::recognition {
namespace {

// Angle of a pixel, rad: coarser than a Kinect's, so that a surface leaves no holes; 3 mm at
// 0.85 m.
constexpr float kPitch = 0.0035F;
// How far around the segment the window reaches, m at the segment's distance.
constexpr float kMarginM = 0.12F;
constexpr int kLargestSide = 2000;
constexpr float kPerPitch = 1 / kPitch;
constexpr float kSide = kLargestSide + 2;
// What stands before an edge of the segment is at most so many pixels from it, and nearer by this.
constexpr int kEdgePixels = 3;
constexpr float kBeforeM = 0.02F;
// Share of all the segment's edges that must be cut off for a side to be hidden.
constexpr double kCutShare = 0.04;

bool IsMeasured(const Eigen::Vector3f& p) { return p.allFinite() && p.z() > 0; }

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
    : sensor_world_(world_sensor.inverse().cast<float>()), segmented_(scan.segmented) {
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
              .cast<int>()
              .array()
              .min(kLargestSide) +
          1;
  pixels_.resize(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()));
  const auto put = [&](const Eigen::Vector3f& p, bool of_segment) {
    if (!IsMeasured(p)) return;
    const Eigen::Vector2i at = Project(p);
    Pixel* pixel = const_cast<Pixel*>(PixelAt(at));
    if (pixel == nullptr || (pixel->depth_m > 0 && pixel->depth_m <= p.z() && !of_segment)) return;
    *pixel = {p.z(), of_segment};
  };
  if (scan.is_image()) {
    const PixelRange range = PixelsIn(scan.depth_image.camera, low_, size_);
    for (int v = range.low.y(); v < range.high.y(); ++v) {
      const auto row =
          static_cast<std::size_t>(v) * static_cast<std::size_t>(scan.depth_image.camera.width);
      for (int u = range.low.x(); u < range.high.x(); ++u) {
        put(scan.PointAt(row + static_cast<std::size_t>(u)), false);
      }
    }
  } else {
    for (const Eigen::Vector3f& p : scan.points) put(p, false);
  }
  for (const std::int32_t i : segment.indices) put(scan.PointAt(i), true);
}

bool Sight::IsCut(const Eigen::Vector2i& at, const Eigen::Vector2i& step,
                  bool unmeasured_too) const {
  bool is_measured = false;
  for (int reach = 1; reach <= kEdgePixels; ++reach) {
    const Pixel* beyond = PixelAt(at + reach * step);
    if (beyond == nullptr || beyond->depth_m <= 0) continue;
    is_measured = true;
    if (!beyond->of_segment && beyond->depth_m < PixelAt(at)->depth_m - kBeforeM) return true;
  }
  return unmeasured_too && !is_measured;
}

Sight::Sides Sight::SidesWhere(bool unmeasured_too) const {
  std::array<int, 4> cut = {};  // right, left, bottom, top
  int ends = 0;                 // of rows and columns of the segment
  for (int y = 0; y < size_.y(); ++y) {
    for (int x = 0; x < size_.x(); ++x) {
      const Eigen::Vector2i at(x, y);
      if (!PixelAt(at)->of_segment) continue;
      for (int side = 0; side < 4; ++side) {
        const Eigen::Vector2i step(side == 0 ? 1 : (side == 1 ? -1 : 0),
                                   side == 2 ? 1 : (side == 3 ? -1 : 0));
        const Pixel* next = PixelAt(at + step);
        if (next != nullptr && next->of_segment) continue;
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
  // Far outside, where an integer has no room, is outside as well.
  const float u = (p.x() / p.z() - low_.x()) * kPerPitch;
  const float v = (p.y() / p.z() - low_.y()) * kPerPitch;
  const bool near = u >= -kSide && u <= kSide && v >= -kSide && v <= kSide;
  return near ? Eigen::Vector2i(static_cast<int>(std::floor(u)), static_cast<int>(std::floor(v)))
              : Eigen::Vector2i(-2, -2);
}

const Sight::Pixel* Sight::PixelAt(int x, int y) const {
  if (x < 0 || y < 0 || x >= size_.x() || y >= size_.y()) return nullptr;
  return &pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.x()) +
                  static_cast<std::size_t>(x)];
}

Sight::Look Sight::At(const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                      float tolerance_m) const {
  const Eigen::Vector2i at = Project(point);
  const float slant = std::abs(normal.dot(point)) / point.norm();
  bool measured = false;
  bool before_by_segment = false;
  bool before_by_other = false;
  float nearest = 1e9F;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const Pixel* pixel = PixelAt(at.x() + dx, at.y() + dy);
      if (pixel == nullptr || pixel->depth_m <= 0) continue;
      // The measured surface lies `ahead` in front of the claimed one, along the line of sight;
      // across the surface it is as much nearer as the surface is slanted.
      const float ahead = point.z() - pixel->depth_m;
      nearest = std::min(nearest, std::abs(ahead) * slant);
      const bool center = dx == 0 && dy == 0;
      measured = measured || center;
      if (!center || ahead * slant <= tolerance_m) continue;
      (pixel->of_segment ? before_by_segment : before_by_other) = true;
    }
  }
  if (nearest < tolerance_m) return {Finding::kThere, nearest};
  if (before_by_other) return {Finding::kHidden, 0};
  if (measured || before_by_segment) return {Finding::kDenied, 0};
  return {segmented_ ? Finding::kMissing : Finding::kUnknown, 0};
}

}  // namespace graspdb::recognition
