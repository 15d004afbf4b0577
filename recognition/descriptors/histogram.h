// A histogram over an interval.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace graspdb::recognition {

// Counts values of [lo, hi] in equal bins; values outside go to the end bins.
//
// Within one hundredth of a bin's width from the edge between two bins a value
// is shared between them, so that rounding in the last digit of a coordinate
// moves a thousandth of a count and not a whole one.
class Histogram {
 public:
  Histogram(double lo, double hi, int bins)
      : lo_(lo), scale_(bins / (hi - lo)), counts_(static_cast<std::size_t>(bins), 0.0) {}

  void Add(double value) {
    const double position = (value - lo_) * scale_;
    const double last = static_cast<double>(counts_.size()) - 1;
    const double bin = std::clamp(std::floor(position), 0.0, last);
    const double offset = position - bin;  // in [0, 1] inside the interval
    double shared = 0;
    double other = bin;
    if (offset < kEdge && bin > 0) {
      shared = 0.5 * (1 - offset / kEdge);
      other = bin - 1;
    } else if (1 - offset < kEdge && bin < last) {
      shared = 0.5 * (1 - (1 - offset) / kEdge);
      other = bin + 1;
    }
    counts_[static_cast<std::size_t>(bin)] += 1 - shared;
    counts_[static_cast<std::size_t>(other)] += shared;
    total_ += 1;
  }

  // Writes the counts scaled to a sum of `mass`; all zero when nothing was added.
  void Write(double mass, std::span<float> out) const {
    const double factor = total_ > 0 ? mass / total_ : 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      out[i] = static_cast<float>(counts_[i] * factor);
    }
  }

  std::size_t size() const { return counts_.size(); }

 private:
  static constexpr double kEdge = 0.01;

  double lo_;
  double scale_;
  std::vector<double> counts_;
  double total_ = 0;
};

}  // namespace graspdb::recognition
