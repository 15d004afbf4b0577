#include "rendering/camera/sensor_effects.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "rendering/camera/scene.h"
#include "rendering/random/counter_random.h"

namespace graspdb::rendering {
namespace {

// A field over an image with mean 0 and variance 1 everywhere: normal random numbers on a lattice
// of `length_px` pixels, bilinear in between. The same for the same seed and stream. Immutable.
class SmoothField {
 public:
  SmoothField(std::uint64_t seed, std::uint64_t stream, int width, int height, double length_px)
      : per_pixel_(1 / std::max(1.0, length_px)),
        row_(static_cast<std::size_t>(width * per_pixel_) + 2) {
    const std::size_t count = row_ * (static_cast<std::size_t>(height * per_pixel_) + 2);
    lattice_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      lattice_.push_back(static_cast<float>(RandomGaussian(seed, stream, i)));
    }
  }

  double At(int u, int v) const {
    const double x = u * per_pixel_;
    const double y = v * per_pixel_;
    const auto column = static_cast<std::size_t>(x);
    const auto line = static_cast<std::size_t>(y);
    const double fx = x - static_cast<double>(column);
    const double fy = y - static_cast<double>(line);
    const float* corner = &lattice_[line * row_ + column];
    const double weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += weights[i] * static_cast<double>(corner[(i / 2) * row_ + i % 2]);
      squares += weights[i] * weights[i];
    }
    return sum / std::sqrt(squares);
  }

 private:
  double per_pixel_;
  std::size_t row_;
  std::vector<float> lattice_;
};

// Independent fields.
enum Field : std::uint64_t { kFrayU = 20, kFrayV, kEdgeLoss, kHoles, kWarp, kBumps };

void Lose(std::size_t pixel, IdealFrame& frame) {
  frame.depth_m[pixel] = 0;
  frame.surface[pixel] = kNoSurface;
}

std::size_t PixelAt(const IdealFrame& frame, int u, int v) {
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
         static_cast<std::size_t>(u);
}

// A pixel's position in the projector's image is shifted to the right by the disparity: a pixel to
// the left of a nearer one there is in its shadow.
void CastShadows(double baseline_m, double focal_px, IdealFrame& frame) {
  if (baseline_m <= 0) return;
  for (int v = 0; v < frame.height; ++v) {
    double farthest_right = -1e9;
    for (int u = 0; u < frame.width; ++u) {
      const std::size_t pixel = PixelAt(frame, u, v);
      const double depth = frame.depth_m[pixel];
      if (depth <= 0) continue;
      const double place = u + focal_px * baseline_m / depth;
      // Half a pixel, so that a slanted surface does not shadow itself.
      if (place < farthest_right - 0.5) Lose(pixel, frame);
      farthest_right = std::max(farthest_right, place);
    }
  }
}

void FrayEdges(const SensorEffects& effects, std::uint64_t seed, IdealFrame& frame) {
  if (effects.fray_px <= 0) return;
  const SmoothField across(seed, kFrayU, frame.width, frame.height, effects.fray_length_px);
  const SmoothField along(seed, kFrayV, frame.width, frame.height, effects.fray_length_px);
  const IdealFrame ideal = frame;
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const long from_u = std::lround(u + effects.fray_px * across.At(u, v));
      const long from_v = std::lround(v + effects.fray_px * along.At(u, v));
      if (from_u < 0 || from_v < 0 || from_u >= frame.width || from_v >= frame.height) continue;
      const std::size_t to = PixelAt(frame, u, v);
      const std::size_t from = PixelAt(frame, static_cast<int>(from_u), static_cast<int>(from_v));
      // On one surface the window contains the pixel's own depth.
      if (std::abs(ideal.depth_m[from] - ideal.depth_m[to]) < kDepthJumpM) continue;
      frame.depth_m[to] = ideal.depth_m[from];
      frame.incidence_rad[to] = ideal.incidence_rad[from];
      frame.surface[to] = ideal.surface[from];
    }
  }
}

// Chessboard distance transform of the jumps of depth, in pixels, `most` where that is less
// (Rosenfeld and Pfaltz 1966: two passes).
std::vector<float> DistancesToJumps(const IdealFrame& frame, double most) {
  std::vector<float> out(frame.depth_m.size(), static_cast<float>(most));
  const auto jump = [&](std::size_t a, std::size_t b) {
    return std::abs(frame.depth_m[a] - frame.depth_m[b]) > kDepthJumpM;
  };
  for (int v = 0; v + 1 < frame.height; ++v) {
    for (int u = 0; u + 1 < frame.width; ++u) {
      const std::size_t pixel = PixelAt(frame, u, v);
      for (const std::size_t beside : {PixelAt(frame, u + 1, v), PixelAt(frame, u, v + 1)}) {
        if (jump(pixel, beside)) out[pixel] = out[beside] = 0;
      }
    }
  }
  const auto spread = [&](int u, int v, int step) {
    const std::size_t pixel = PixelAt(frame, u, v);
    for (const auto& [du, dv] : {std::pair(-1, 0), {-1, -1}, {0, -1}, {1, -1}}) {
      const int from_u = u + step * du;
      const int from_v = v + step * dv;
      if (from_u < 0 || from_v < 0 || from_u >= frame.width || from_v >= frame.height) continue;
      out[pixel] = std::min(out[pixel], out[PixelAt(frame, from_u, from_v)] + 1);
    }
  };
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) spread(u, v, 1);
  }
  for (int v = frame.height - 1; v >= 0; --v) {
    for (int u = frame.width - 1; u >= 0; --u) spread(u, v, -1);
  }
  return out;
}

// Of a standard normal variable.
double Cumulated(double deviations) { return 0.5 * std::erfc(-deviations / std::numbers::sqrt2); }

void LoseEdges(const SensorEffects& effects, std::uint64_t seed, IdealFrame& frame) {
  if (effects.edge_loss_chance <= 0) return;
  const std::vector<float> distances = DistancesToJumps(frame, effects.edge_loss_px);
  const SmoothField field(seed, kEdgeLoss, frame.width, frame.height, effects.fray_length_px);
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const std::size_t pixel = PixelAt(frame, u, v);
      const double near = 1 - static_cast<double>(distances[pixel]) / effects.edge_loss_px;
      if (near <= 0) continue;
      if (Cumulated(field.At(u, v)) < effects.edge_loss_chance * near) Lose(pixel, frame);
    }
  }
}

void MakeHoles(const SensorEffects& effects, std::uint64_t seed, IdealFrame& frame) {
  if (effects.hole_deviations <= 0) return;
  const SmoothField field(seed, kHoles, frame.width, frame.height, effects.hole_length_px);
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      if (field.At(u, v) < -effects.hole_deviations) Lose(PixelAt(frame, u, v), frame);
    }
  }
}

}  // namespace

void ApplyEdgeEffects(const SensorEffects& effects, double focal_px, std::uint64_t seed,
                      IdealFrame& frame) {
  CastShadows(effects.shadow_baseline_m, focal_px, frame);
  FrayEdges(effects, seed, frame);
  LoseEdges(effects, seed, frame);
  MakeHoles(effects, seed, frame);
}

void ApplyDepthEffects(const SensorEffects& effects, std::uint64_t seed, IdealFrame& frame) {
  if (effects.warp_m <= 0 && effects.bumps_m <= 0 && effects.scale == 1) return;
  const SmoothField warp(seed, kWarp, frame.width, frame.height, effects.warp_length_px);
  const SmoothField bumps(seed, kBumps, frame.width, frame.height, effects.bumps_length_px);
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      float& depth = frame.depth_m[PixelAt(frame, u, v)];
      if (depth <= 0) continue;
      const double z = depth;
      const double off = effects.warp_m * warp.At(u, v) + effects.bumps_m * bumps.At(u, v);
      depth = static_cast<float>(effects.scale * (z + off * z * z));
    }
  }
}

}  // namespace graspdb::rendering
