// An object as a grey picture with a caption.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace graspdb::pictures {

struct ColoredPixel {
  std::size_t pixel = 0;  // counted row by row
  std::uint32_t rgb = 0;  // 0xRRGGBB
};

struct ShadedPicture {
  std::string caption;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> brightness;  // per pixel, row by row: 0 black, 255 white
  std::vector<ColoredPixel> marks = {};  // drawn over it, the last on top
};

// Writes a PNG, the caption above. INVALID_ARGUMENT when `brightness` has another size or a mark is
// outside the picture, FAILED_PRECONDITION when the file cannot be written.
absl::Status WriteShadedPicture(const std::filesystem::path& path, const ShadedPicture& picture);

}  // namespace graspdb::pictures
