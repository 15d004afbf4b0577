// Some hundred descriptors, packed for searching.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "recognition/descriptors/descriptor.h"
#include "recognition/index/root_projection.h"
#include "recognition/models/taught.h"

namespace graspdb::recognition {

// A view with its descriptor.
struct IndexedView {
  std::shared_ptr<const TaughtView> view;
  Descriptor descriptor;
};

// The descriptor of a query.
struct DescriptorQuery {
  explicit DescriptorQuery(const Descriptor& descriptor);

  std::vector<float> bins;  // padded with zeros
};

// Numbers to encode as bytes.
struct CodedNumbers {
  std::vector<float> values;
  float rounding = 0;  // upper bound of their distance from the exact numbers
};

// Of a histogram: its roots, or their projected components.
CodedNumbers NumbersToCode(const Descriptor& descriptor, const RootProjection* projection);

// Rows of bins, and bytes that bound each distance from below for a fraction of the memory traffic
// and arithmetic.
//
// With H the Euclidean distance of the roots of two histograms (Hellinger's, but for a factor),
// chi-square = sum (a - b)^2 / (a + b) = sum (sqrt a - sqrt b)^2 (sqrt a + sqrt b)^2 / (a + b) lies
// between H^2 and 2 H^2, since (sqrt a + sqrt b)^2 lies between a + b and 2 (a + b). The bytes are
// rounded roots, or with a projection its components, whose distance is not above H either; the
// rounding error of every row is known, so that the triangle inequality bounds H from below.
// Immutable; safe for concurrent reads.
class DescriptorChunk {
 public:
  // Without a projection a view takes a byte a bin.
  DescriptorChunk(std::span<const IndexedView> views,
                  std::shared_ptr<const RootProjection> projection);

  std::size_t size() const { return views_.size(); }
  std::size_t bins() const { return bins_; }
  const std::vector<std::shared_ptr<const TaughtView>>& views() const { return views_; }
  Descriptor DescriptorOf(std::size_t i) const;
  // Null when there is none.
  const std::shared_ptr<const RootProjection>& projection() const { return projection_; }

  // Writes a lower bound of each row's chi-square distance; `out` has size(). `coded` is the
  // query's projection where there is one, else its roots.
  void Bound(const CodedNumbers& coded, std::span<float> out) const;

  // Chi-square distance of row `i`.
  float Distance(const DescriptorQuery& query, std::size_t i) const;

 private:
  std::vector<std::shared_ptr<const TaughtView>> views_;
  std::size_t bins_ = 0;
  std::size_t row_ = 0;       // floats a row, padded
  std::size_t code_row_ = 0;  // bytes a row, padded
  float lowest_ = 0;          // byte = (number - lowest) * scale
  float scale_ = 1;
  std::vector<float> rows_;
  std::vector<std::uint8_t> codes_;
  std::vector<float> rounded_off_;  // a row: rounding error of its bytes
  std::shared_ptr<const RootProjection> projection_;
};

}  // namespace graspdb::recognition
