// The header of an input of the fuzzer range_image.
#pragma once

#include <cstdint>

namespace graspdb::fuzz {

// The bytes of the image follow.
struct RangeImageHeader {
  std::uint8_t format = 0;  // C16, C32f, ABC16, ABC32f
  std::uint8_t mode = 0;    // Scan3dOutputMode, as range_image_fuzz.cc lists them
  std::uint8_t unit = 0;    // Scan3dDistanceUnit, the same
  std::uint8_t flags = 3;   // 1: scale, 2: invalid value, 4: intrinsics are given
  std::int16_t width = 2;
  std::int16_t height = 2;
  std::uint16_t row_bytes = 4;  // of Z16
  std::uint16_t unused = 0;
  float scale = 0.25F;
  float offset = 0;
  float invalid = 0;
  float focal_length = 500;
  float aspect_ratio = 1;
  float principal = 1;
  float baseline_m = 0.16F;
};
static_assert(sizeof(RangeImageHeader) == 40, "without padding");

}  // namespace graspdb::fuzz
