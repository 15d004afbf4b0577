// Errors of real depth cameras besides per-pixel noise: holes, frayed edges, shadows, warps.
#pragma once

#include <cstdint>

#include "rendering/camera/ray_caster.h"

namespace graspdb::rendering {

// Errors that are correlated between pixels. The default is none. Lengths in pixels are correlation
// lengths. The sources of the values are in docs/experiment.md.
struct SensorEffects {
  // Matching windows shift an edge by some pixels (Handa et al., "A Benchmark for RGB-D Visual
  // Odometry, 3D Reconstruction and SLAM", ICRA 2014): standard deviation of the shift.
  double fray_px = 0;
  double fray_length_px = 5;
  // Probability that a pixel beside a depth jump is lost; it falls to 0 within `edge_loss_px`.
  double edge_loss_chance = 0;
  double edge_loss_px = 6;
  // Distance of the projector to the left of the camera, m: surfaces in its shadow are lost. 0: no
  // projector.
  double shadow_baseline_m = 0;
  // Pixels that the camera loses on any surface: where a field of unit variance is below
  // -`hole_deviations` (2: 2.3 %). 0: none.
  double hole_deviations = 0;
  double hole_length_px = 6;
  // Standard deviation of errors at 1 m, m; they grow with the square of the depth: of lens and
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

// Effects before per-pixel noise: shadows, frayed and lost edges, holes. A lost pixel has depth 0
// and surface kNoSurface. Deterministic. `focal_px` is along x.
void ApplyEdgeEffects(const SensorEffects& effects, double focal_px, std::uint64_t seed,
                      IdealFrame& frame);

// Effects after per-pixel noise: warps, bumps and scale. Deterministic.
void ApplyDepthEffects(const SensorEffects& effects, std::uint64_t seed, IdealFrame& frame);

}  // namespace graspdb::rendering
