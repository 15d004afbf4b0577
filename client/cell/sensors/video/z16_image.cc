#include "client/cell/sensors/video/z16_image.h"

#include <bit>
#include <cstring>

#include "absl/strings/str_cat.h"

namespace graspdb::client {
namespace {

static_assert(std::endian::native == std::endian::little, "Z16 is little-endian");

constexpr std::size_t kBytesOfPixel = 2;

struct Model {
  const char* name;  // a part of the product's name; the first that fits counts
  double unit_m;
};

// The default depth units of Intel's SDK (RS2_OPTION_DEPTH_UNITS).
constexpr Model kModels[] = {
    {"RealSense(TM) Depth Camera 405", 0.0001},
    {"RealSense(TM) Depth Camera 4", 0.001},
    {"L515", 0.00025},
    {"SR300", 0.000125},
    {"SR305", 0.000125},
};

}  // namespace

absl::StatusOr<std::vector<std::uint16_t>> CountsOfZ16(std::span<const char> data,
                                                       const Z16Layout& layout) {
  if (layout.width < 1 || layout.height < 1 ||
      layout.bytes_per_row < kBytesOfPixel * static_cast<std::size_t>(layout.width)) {
    return absl::InvalidArgumentError(absl::StrCat("an image of ", layout.width, " x ",
                                                   layout.height, " pixels has rows of ",
                                                   layout.bytes_per_row, " bytes"));
  }
  const auto width = static_cast<std::size_t>(layout.width);
  const auto height = static_cast<std::size_t>(layout.height);
  const std::size_t row = kBytesOfPixel * width;
  // The last row may end with its pixels.
  if (data.size() < row || (data.size() - row) / layout.bytes_per_row < height - 1) {
    return absl::DataLossError(absl::StrCat("an image of ", width, " x ", height,
                                            " pixels came with ", data.size(), " bytes"));
  }
  std::vector<std::uint16_t> counts(width * height);
  for (std::size_t v = 0; v < height; ++v) {
    std::memcpy(counts.data() + v * width, data.data() + v * layout.bytes_per_row, row);
  }
  return counts;
}

std::optional<double> DepthUnitOfModel(const std::string& name) {
  for (const Model& model : kModels) {
    if (name.find(model.name) != std::string::npos) return model.unit_m;
  }
  return std::nullopt;
}

}  // namespace graspdb::client
