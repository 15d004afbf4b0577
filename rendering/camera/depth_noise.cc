#include "rendering/camera/depth_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "rendering/random/counter_random.h"

namespace graspdb::rendering {
namespace {

constexpr double kMaxNoiseM = 0.05;  // the slant term has no bound

// Independent random numbers for one pixel.
enum Stream : std::uint64_t { kAxial, kDropout, kFlyingChance, kFlyingNeighbour, kFlyingShare };

bool IsLost(const DepthNoise& noise, std::uint64_t seed, std::size_t pixel, double incidence) {
  if (noise.dropout_end_rad <= 0 || incidence <= noise.dropout_begin_rad) return false;
  if (incidence >= noise.dropout_end_rad) return true;
  const double chance =
      (incidence - noise.dropout_begin_rad) / (noise.dropout_end_rad - noise.dropout_begin_rad);
  return RandomUniform(seed, kDropout, pixel) < chance;
}

// The depth of a pixel beside `pixel`, chosen at random; 0 beyond the image.
float NeighbourDepth(const std::vector<float>& depth, const IdealFrame& frame, std::uint64_t seed,
                     std::size_t pixel) {
  constexpr std::array<std::array<int, 2>, 4> kNeighbours = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  const auto width = static_cast<std::size_t>(frame.width);
  const auto& [du, dv] =
      kNeighbours[RandomBits(seed, kFlyingNeighbour, pixel) % kNeighbours.size()];
  const int u = static_cast<int>(pixel % width) + du;
  const int v = static_cast<int>(pixel / width) + dv;
  if (u < 0 || v < 0 || u >= frame.width || v >= frame.height) return 0;
  return depth[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)];
}

void MixEdges(const DepthNoise& noise, std::uint64_t seed, IdealFrame& frame) {
  if (noise.flying_chance <= 0) return;
  const std::vector<float> ideal = frame.depth_m;
  for (std::size_t i = 0; i < ideal.size(); ++i) {
    if (ideal[i] <= 0 || RandomUniform(seed, kFlyingChance, i) >= noise.flying_chance) continue;
    const float beside = NeighbourDepth(ideal, frame, seed, i);
    if (beside <= 0 || std::abs(beside - ideal[i]) <= noise.flying_jump_m) continue;
    const double share = RandomUniform(seed, kFlyingShare, i);
    frame.depth_m[i] = static_cast<float>((1 - share) * ideal[i] + share * beside);
    frame.surface[i] = kFlyingPixel;
  }
}

double Quantised(double depth_m, double disparity_steps_m) {
  if (disparity_steps_m <= 0) return depth_m;
  return disparity_steps_m / std::max(1.0, std::round(disparity_steps_m / depth_m));
}

}  // namespace

double AxialDeviation(const AxialNoise& noise, double depth_m, double incidence_rad) {
  const double from_origin = depth_m - noise.origin;
  const double grazing = std::max(std::numbers::pi / 2 - incidence_rad, 1e-6);
  const double ratio = incidence_rad / grazing;
  const double slant = noise.slant * std::pow(depth_m, noise.slant_power) * ratio * ratio;
  const double deviation =
      noise.offset + noise.linear * depth_m + noise.quadratic * from_origin * from_origin + slant;
  return std::clamp(deviation, 0.0, kMaxNoiseM);
}

void ApplyNoise(const DepthNoise& noise, std::uint64_t seed, IdealFrame& frame) {
  if (!(noise.scale > 0)) return;
  MixEdges(noise, seed, frame);
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i) {
    if (frame.depth_m[i] <= 0) continue;
    const double ideal = frame.depth_m[i];
    const double incidence = frame.incidence_rad[i];
    const double deviation = noise.scale * AxialDeviation(noise.axial, ideal, incidence);
    const double noisy = ideal + deviation * RandomGaussian(seed, kAxial, i);
    const bool lost = IsLost(noise, seed, i, incidence) || noisy <= 0;
    frame.depth_m[i] = lost ? 0.0F : static_cast<float>(Quantised(noisy, noise.disparity_steps_m));
    if (lost) frame.surface[i] = kNoSurface;
  }
}

}  // namespace graspdb::rendering
