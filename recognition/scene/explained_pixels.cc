#include "recognition/scene/explained_pixels.h"

#include <algorithm>
#include <cmath>

#include "recognition/scene/image_evidence.h"

namespace graspdb::recognition {
namespace {

// The gaps between the points of a model are smaller, pixels to each side.
constexpr int kGapPx = 2;
// Surfaces nearer than this are the same, m.
constexpr float kExplainedWithinM = 0.012F;

// The area of a block's object pixels, m2; 0 where one of them is explained.
double OpenArea(const Frame& frame, int left, int top, int side) {
  double out = 0;
  for (int v = top; v < top + side; ++v) {
    for (int u = left; u < left + side; ++u) {
      const std::size_t i = frame.PixelAt(u, v);
      if (frame.role[i] == PixelRole::kExplained) return 0;
      if (frame.role[i] != PixelRole::kObject) continue;
      out += static_cast<double>(frame.depth[i] * frame.depth[i]);
    }
  }
  return out / (frame.camera.fx * frame.camera.fy);
}

}  // namespace

Pixels PixelsOn(const Frame& frame, const ImageModel& model,
                const Eigen::Isometry3f& sensor_model) {
  const ModelAspect aspect = model.AspectSeenFrom(sensor_model.inverse().translation(), 0);
  std::vector<bool> is_on(frame.depth.size(), false);
  Eigen::AlignedBox2i box;
  for (const std::uint16_t i : aspect.visible) {
    const Eigen::Vector3f p = sensor_model * model.surface.points[i];
    const std::ptrdiff_t middle = frame.PixelOf(p);
    if (middle < 0) continue;
    const int u = static_cast<int>(middle) % frame.camera.width;
    const int v = static_cast<int>(middle) / frame.camera.width;
    for (int y = v - kGapPx; y <= v + kGapPx; ++y) {
      for (int x = u - kGapPx; x <= u + kGapPx; ++x) {
        if (!frame.Contains(x, y)) continue;
        const std::size_t pixel = frame.PixelAt(x, y);
        if (std::abs(frame.depth[pixel] - p.z()) >= kExplainedWithinM) continue;
        is_on[pixel] = true;
        box.extend(Eigen::Vector2i(x, y));
      }
    }
  }
  Pixels out;
  if (box.isEmpty()) return out;
  for (int y = box.min().y(); y <= box.max().y(); ++y) {
    for (int x = box.min().x(); x <= box.max().x(); ++x) {
      const std::size_t pixel = frame.PixelAt(x, y);
      if (is_on[pixel]) out.push_back(pixel);
    }
  }
  return out;
}

void Explain(const Pixels& pixels, Frame* frame) {
  for (const std::size_t i : pixels) {
    if (frame->role[i] == PixelRole::kObject) frame->role[i] = PixelRole::kExplained;
  }
}

double ExplainedShare(const Frame& frame, const Pixels& pixels) {
  if (pixels.empty()) return 1;
  const auto explained = std::ranges::count_if(
      pixels, [&](std::size_t i) { return frame.role[i] == PixelRole::kExplained; });
  return static_cast<double>(explained) / static_cast<double>(pixels.size());
}

double UnexplainedArea(const Frame& frame) {
  constexpr int kBlock = 8;
  double out = 0;
  for (int v = 0; v + kBlock <= frame.camera.height; v += kBlock) {
    for (int u = 0; u + kBlock <= frame.camera.width; u += kBlock) {
      out += OpenArea(frame, u, v, kBlock);
    }
  }
  return out;
}

}  // namespace graspdb::recognition
