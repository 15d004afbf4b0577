// Adds the errors of a real depth camera to an ideal depth image.
#pragma once

#include <cstdint>

#include "rendering/camera/ray_caster.h"

namespace graspdb::rendering {

// The axial standard deviation in metres, for a depth z in metres and an angle t
// in radians between the ray and the normal of the surface, is
//   offset + linear z + quadratic (z - origin)^2 + slant z^slant_power t^2 / (pi/2 - t)^2
struct AxialNoise {
  double offset = 0;
  double linear = 0;
  double quadratic = 0;
  double origin = 0;
  double slant = 0;
  double slant_power = 0;
  bool operator==(const AxialNoise&) const = default;
};

// The errors of a depth camera. The default is none.
struct DepthNoise {
  AxialNoise axial;
  // Multiplies the axial deviation. 0 makes an ideal camera, without the errors below.
  double scale = 1;
  // Pixels whose ray is at a larger angle to the surface normal than `begin` are lost with growing
  // probability, and beyond `end` always. Radians.
  double dropout_begin_rad = 0;
  double dropout_end_rad = 0;  // 0: none are lost
  // Structured light quantizes disparity: depth = this / step, in metre steps; 0: not quantized.
  double disparity_steps_m = 0;
  // Probability that a pixel on a depth jump lies between the two surfaces, which time-of-flight
  // cameras mix.
  double flying_chance = 0;
  // A jump is larger than this; metres.
  double flying_jump_m = 0.02;
  bool operator==(const DepthNoise&) const = default;
};

// sigma_z(z, t) before scaling; metres. At most 0.05 m.
double AxialDeviation(const AxialNoise& noise, double depth_m, double incidence_rad);

// Applies the errors to depth and surface of `frame`; deterministic for a seed, independent of the
// order of the pixels. A lost pixel has depth 0 and surface kNoSurface.
void ApplyNoise(const DepthNoise& noise, std::uint64_t seed, IdealFrame& frame);

}  // namespace graspdb::rendering
