#include "recognition/verification/depth_buffer.h"

#include <array>

namespace graspdb::recognition {
namespace {

// Occluders of an edge of the segment are at most this many pixels from it, and nearer by this.
constexpr int kEdgePixels = 3;
constexpr float kBeforeM = 0.02F;
// Share of all the segment's edges that must be cut off for a side to be hidden.
constexpr double kCutShare = 0.04;
// Ratio of the cut edges of two opposite sides from which on only one is hidden: all edges fray.
constexpr double kDominates = 2;

}  // namespace

DepthBuffer::DepthBuffer(const ScanDepths& depths, const Pose& world_sensor, const Segment& segment)
    : sensor_world_(world_sensor.inverse().cast<float>()),
      alone_(depths.scan().segmented),
      window_(depths.WindowAround(segment)) {
  if (window_.is_empty()) return;
  constexpr std::size_t kBorders = std::size_t{2} * kBorder;
  row_ = static_cast<std::size_t>(window_.size.x()) + kBorders;
  depths_.assign(row_ * (static_cast<std::size_t>(window_.size.y()) + kBorders), 0);
  depths.Copy(window_, PlaceOf({0, 0}), row_, &depths_);
  for (const std::int32_t i : segment.indices) {
    const Eigen::Vector3f p = depths.scan().PointAt(i);
    if (!IsMeasured(p)) continue;
    const Eigen::Vector2i at = window_.PixelOf(p);
    if (at.x() >= 0) depths_[PlaceOf(at)] = p.z();
  }
}

bool DepthBuffer::IsCut(const Eigen::Vector2i& at, const Eigen::Vector2i& step,
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

DepthBuffer::Sides DepthBuffer::SidesWhere(bool unmeasured_too) const {
  std::array<int, 4> cut = {};  // right, left, bottom, top
  int ends = 0;                 // of rows and columns of the segment
  for (int y = 0; y < window_.size.y(); ++y) {
    for (int x = 0; x < window_.size.x(); ++x) {
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
  // Sides are numbered so that the opposite one differs in the last bit.
  const auto is_cut = [&](int side) {
    const int here = cut[static_cast<std::size_t>(side)];
    return here > kCutShare * ends && kDominates * here > cut[static_cast<std::size_t>(side ^ 1)];
  };
  return {.left = is_cut(1), .right = is_cut(0), .top = is_cut(3), .bottom = is_cut(2)};
}

simd::DepthWindow DepthBuffer::window() const {
  if (depths_.empty()) return {};
  simd::DepthWindow out = window_.Of(&depths_[PlaceOf({0, 0})], row_);
  out.alone = alone_;
  return out;
}

}  // namespace graspdb::recognition
