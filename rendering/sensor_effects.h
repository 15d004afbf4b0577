// What real depth cameras do to a depth image besides noise of single pixels: holes, frayed edges,
// shadows, warps.
#pragma once

#include <cstdint>

#include "rendering/ray_caster.h"

namespace graspdb::client {

// Errors that neighbouring pixels share. The default is none. Lengths in pixels are those over
// which an error stays alike. docs/experiment.md says where the values come from.
struct SensorEffects {
  // Matching windows see an edge some pixels beside its place (Handa et al., "A Benchmark for RGB-D
  // Visual Odometry, 3D Reconstruction and SLAM", ICRA 2014): standard deviation of the shift.
  double fray_px = 0;
  double fray_length_px = 5;
  // Chance that a pixel beside a jump of depth is lost; it falls to 0 within `edge_loss_px`.
  double edge_loss_chance = 0;
  double edge_loss_px = 6;
  // Distance of the projector to the left of the camera, m: what it does not light up is lost.
  // 0: there is none.
  double shadow_baseline_m = 0;
  // Pixels that the camera loses on any surface: where a field of unit variance is below
  // -`hole_deviations` (2: 2.3 %). 0: none.
  double hole_deviations = 0;
  double hole_length_px = 6;
  // Standard deviation of errors at 1 m, m; they grow with the square of the depth. Of lens and
  // projector, over the image, and of single matching windows.
  double warp_m = 0;
  double warp_length_px = 100;
  double bumps_m = 0;
  double bumps_length_px = 8;
  // Factor on every measured depth.
  double scale = 1;
  bool operator==(const SensorEffects&) const = default;
};

// A jump of depth between neighbours is larger than this, m.
inline constexpr double kDepthJumpM = 0.02;

// What moves or hides edges, before the noise of pixels: shadows, frayed and lost edges, holes. A
// lost pixel has depth 0 and shows kNoSurface. Deterministic. `focal_px` is along x.
void ApplyEdgeEffects(const SensorEffects& effects, double focal_px, std::uint64_t seed,
                      IdealFrame& frame);

// What changes measured depths, after it: warps, bumps and scale. Deterministic.
void ApplyDepthEffects(const SensorEffects& effects, std::uint64_t seed, IdealFrame& frame);

}  // namespace graspdb::client
