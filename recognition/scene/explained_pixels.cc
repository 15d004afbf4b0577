#include "recognition/scene/explained_pixels.h"

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

std::vector<bool> PixelsOn(const Frame& frame, const ImageModel& model,
                           const Eigen::Isometry3f& sensor_model) {
  std::vector<bool> out(frame.depth.size(), false);
  const ModelAspect aspect = model.AspectSeenFrom(sensor_model.inverse().translation(), 0);
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
        if (std::abs(frame.depth[pixel] - p.z()) < kExplainedWithinM) out[pixel] = true;
      }
    }
  }
  return out;
}

void Explain(const std::vector<bool>& pixels, Frame* frame) {
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i] && frame->role[i] == PixelRole::kObject) frame->role[i] = PixelRole::kExplained;
  }
}

double ExplainedShare(const Frame& frame, const std::vector<bool>& pixels) {
  double explained = 0;
  double all = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels[i]) continue;
    all += 1;
    explained += frame.role[i] == PixelRole::kExplained ? 1 : 0;
  }
  return all > 0 ? explained / all : 1;
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
