#include "recognition/descriptor_chunk.h"

#include <algorithm>
#include <cmath>

#include "recognition/wide.h"

namespace graspdb::recognition {
namespace {

constexpr float kLargestCode = 255;
// Bounds are made smaller by this share: sums of floats are not exact.
constexpr float kRounding = 1e-5F;

float Root(float bin) { return std::sqrt(std::max(0.0F, bin)); }

std::vector<float> RootsOf(const Descriptor& descriptor) {
  std::vector<float> out(descriptor.size());
  std::ranges::transform(descriptor, out.begin(), Root);
  return out;
}

// Writes the bytes of some roots; returns how far they are from the roots.
float Encode(std::span<const float> roots, float scale, std::uint8_t* out) {
  double squares = 0;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const float code = std::min(kLargestCode, std::round(roots[i] * scale));
    out[i] = static_cast<std::uint8_t>(code);
    const auto off = static_cast<double>(roots[i] - code / scale);
    squares += off * off;
  }
  return static_cast<float>(std::sqrt(squares));
}

}  // namespace

DescriptorQuery::DescriptorQuery(const Descriptor& descriptor)
    : bins(wide::Padded(descriptor.size()), 0.0F), roots(RootsOf(descriptor)) {
  std::ranges::copy(descriptor, bins.begin());
}

DescriptorChunk::DescriptorChunk(std::span<const IndexedView> views) {
  if (views.empty()) return;
  bins_ = views.front().descriptor.size();
  row_ = wide::Padded(bins_);
  code_row_ = wide::PaddedBytes(bins_);
  rows_.assign(row_ * views.size(), 0);
  codes_.assign(code_row_ * views.size(), 0);
  views_.reserve(views.size());
  rounded_off_.reserve(views.size());
  float largest = 0;
  for (const IndexedView& v : views) largest = std::max(largest, std::ranges::max(v.descriptor));
  if (largest > 0) scale_ = kLargestCode / Root(largest);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Descriptor& descriptor = views[i].descriptor;
    views_.push_back(views[i].view);
    std::ranges::copy(descriptor, rows_.begin() + static_cast<std::ptrdiff_t>(i * row_));
    rounded_off_.push_back(Encode(RootsOf(descriptor), scale_, codes_.data() + i * code_row_));
  }
}

Descriptor DescriptorChunk::DescriptorOf(std::size_t i) const {
  const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(i * row_);
  return {begin, begin + static_cast<std::ptrdiff_t>(bins_)};
}

void DescriptorChunk::Bound(const DescriptorQuery& query, std::span<float> out) const {
  std::vector<std::uint8_t> code(code_row_, 0);
  const float query_off = Encode(query.roots, scale_, code.data());
  std::vector<std::int32_t> squares(size());
  wide::Best().byte_distances(codes_.data(), code_row_, size(), code.data(), squares.data());
  for (std::size_t i = 0; i < size(); ++i) {
    const float between = std::sqrt(static_cast<float>(squares[i])) / scale_;
    const float least = std::max(0.0F, between - query_off - rounded_off_[i]);
    out[i] = (1 - kRounding) * least * least;
  }
}

float DescriptorChunk::Distance(const DescriptorQuery& query, std::size_t i) const {
  return wide::Best().chi_square(query.bins.data(), rows_.data() + i * row_, row_);
}

}  // namespace graspdb::recognition
