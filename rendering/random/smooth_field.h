// Correlated random numbers of neighbouring pixels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "rendering/random/counter_random.h"

namespace graspdb::rendering {

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

}  // namespace graspdb::rendering
