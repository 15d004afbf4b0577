// What a real depth camera does to an ideal depth image.
#pragma once

#include <cstdint>

#include "rendering/ray_caster.h"

namespace graspdb::client {

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
  // Multiplies the axial deviation. 0 makes an ideal camera: none of what is
  // below happens either.
  double scale = 1;
  // Pixels whose surface is seen at a larger angle from its normal than `begin`
  // are lost, ever more often, and beyond `end` always. Radians.
  double dropout_begin_rad = 0;
  double dropout_end_rad = 0;  // 0: none are lost
  // Structured light knows disparities in whole steps: depth = this / step, in
  // metre steps; 0 for none.
  double disparity_steps_m = 0;
  // Chance that a pixel on a jump of depth lies between the two surfaces, as
  // time-of-flight cameras mix them.
  double flying_chance = 0;
  // A jump is larger than this; metres.
  double flying_jump_m = 0.02;
  bool operator==(const DepthNoise&) const = default;
};

// sigma_z(z, t) before scaling; metres. At most 0.05 m.
double AxialDeviation(const AxialNoise& noise, double depth_m, double incidence_rad);

// Changes depth and surface of `frame` as the camera would; the same for the
// same seed, whatever the order of the pixels. A lost pixel has depth 0 and shows
// kNoSurface.
void ApplyNoise(const DepthNoise& noise, std::uint64_t seed, IdealFrame& frame);

}  // namespace graspdb::client
