// The parts of a descriptor by their names in the paper.
#pragma once

#include <numeric>
#include <vector>

#include "recognition/descriptors/descriptor.h"

namespace graspdb::testing {

struct Part {
  const char* name;
  std::size_t begin;
  std::size_t size;
  double lo;  // the interval that is binned
  double hi;
};

inline constexpr double kHalfTurn = 3.14159265358979323846;

// Equations 4, 6, 7: in every descriptor but VFH-308.
inline constexpr Part kAlpha{"cos alpha", 0, 45, -1, 1};
inline constexpr Part kPhi{"cos phi", 45, 45, -1, 1};
inline constexpr Part kTheta{"theta", 90, 45, -kHalfTurn, kHalfTurn};
// Equation 5: VFH-263.
inline constexpr Part kBeta{"cos beta", 135, 128, -1, 1};
// Equations 11 to 13: MVFH-300.
inline constexpr Part kViewAlpha{"cos alpha^M", 135, 55, -1, 1};
inline constexpr Part kViewPhi{"cos phi^M", 190, 55, -1, 1};
inline constexpr Part kViewTheta{"theta^M", 245, 55, -kHalfTurn, kHalfTurn};

inline std::vector<float> Bins(const recognition::Descriptor& descriptor, const Part& part) {
  const auto begin = descriptor.begin() + static_cast<std::ptrdiff_t>(part.begin);
  return {begin, begin + static_cast<std::ptrdiff_t>(part.size)};
}

inline double Mass(const std::vector<float>& bins) {
  return std::accumulate(bins.begin(), bins.end(), 0.0);
}

}  // namespace graspdb::testing
