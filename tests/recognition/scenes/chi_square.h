// The distance of two descriptors, in double precision.
#pragma once

#include <cstddef>

#include "recognition/descriptors/descriptor.h"

namespace graspdb::testing {

// sum((a - b)^2 / (a + b)).
inline double ChiSquareDistance(const recognition::Descriptor& a,
                                const recognition::Descriptor& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double total = static_cast<double>(a[i]) + b[i];
    const double difference = static_cast<double>(a[i]) - b[i];
    if (total > 0) sum += difference * difference / total;
  }
  return sum;
}

}  // namespace graspdb::testing
