// Some hundred descriptors, packed for searching.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "recognition/descriptor.h"
#include "recognition/taught.h"

namespace graspdb::recognition {

// A view with its descriptor.
struct IndexedView {
  std::shared_ptr<const TaughtView> view;
  Descriptor descriptor;
};

// A descriptor that is looked for.
struct DescriptorQuery {
  explicit DescriptorQuery(const Descriptor& descriptor);

  std::vector<float> bins;   // padded with zeros
  std::vector<float> roots;  // of the bins
};

// Rows of bins, and the same as bytes, from which a bound of each distance is had for a quarter
// of the memory traffic and arithmetic.
//
// With H the Euclidean distance of the roots of two histograms (Hellinger's, but for a factor),
// chi-square = sum (a - b)^2 / (a + b) = sum (sqrt a - sqrt b)^2 (sqrt a + sqrt b)^2 / (a + b)
// lies between H^2 and 2 H^2, since (sqrt a + sqrt b)^2 lies between a + b and 2 (a + b). The bytes
// are rounded roots; what rounding moved every row by is known, so that the triangle inequality
// bounds H from below. Immutable; safe for concurrent reads.
class DescriptorChunk {
 public:
  explicit DescriptorChunk(std::span<const IndexedView> views);

  std::size_t size() const { return views_.size(); }
  const std::vector<std::shared_ptr<const TaughtView>>& views() const { return views_; }
  Descriptor DescriptorOf(std::size_t i) const;

  // Writes for each row what its chi-square distance is not smaller than; `out` has size().
  void Bound(const DescriptorQuery& query, std::span<float> out) const;

  // Chi-square distance of row `i`.
  float Distance(const DescriptorQuery& query, std::size_t i) const;

 private:
  std::vector<std::shared_ptr<const TaughtView>> views_;
  std::size_t bins_ = 0;
  std::size_t row_ = 0;       // floats a row, padded
  std::size_t code_row_ = 0;  // bytes a row, padded
  float scale_ = 1;           // byte = root * scale
  std::vector<float> rows_;
  std::vector<std::uint8_t> codes_;
  std::vector<float> rounded_off_;  // a row: distance of the roots from what the bytes say
};

}  // namespace graspdb::recognition
