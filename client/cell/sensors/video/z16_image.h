// Depth images of Video4Linux, pixel format Z16.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace graspdb::client {

// The size and the rows of an image; `bytes_per_row` may exceed the pixels.
struct Z16Layout {
  int width = 0;
  int height = 0;
  std::size_t bytes_per_row = 0;
};

// The counts, row by row. DATA_LOSS when `data` does not hold all rows; INVALID_ARGUMENT for a
// layout that is none. Allocates no more than `data` has.
absl::StatusOr<std::vector<std::uint16_t>> CountsOfZ16(std::span<const char> data,
                                                       const Z16Layout& layout);

// Metres a count of the model that the driver calls `card`, as it leaves the factory; nullopt for
// an unknown model. Z16 has no unit of its own.
std::optional<double> DepthUnitOfModel(const std::string& card);

}  // namespace graspdb::client
