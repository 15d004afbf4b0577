#include "recognition/index/descriptor_chunk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "recognition/simd/kernels.h"

namespace graspdb::recognition {
namespace {

constexpr float kLargestCode = 255;
// Bounds are made smaller by this share: sums of floats are not exact.
constexpr float kRounding = 1e-5F;

// Of roots and sums of squares, relative.
constexpr float kRootRounding = std::numeric_limits<float>::epsilon();

float Root(float bin) { return std::sqrt(std::max(0.0F, bin)); }

// How numbers become bytes.
struct Steps {
  float lowest;
  float scale;
};

// Writes numbers as bytes; returns the distance of these from the exact numbers.
float Encode(const CodedNumbers& numbers, const Steps& steps, std::uint8_t* out) {
  double squares = 0;
  for (std::size_t i = 0; i < numbers.values.size(); ++i) {
    const float at = numbers.values[i] - steps.lowest;
    // NaN becomes 0 and makes the sum NaN, which bounds nothing.
    const float code = std::floor(std::min(kLargestCode, std::max(0.0F, at * steps.scale + 0.5F)));
    out[i] = static_cast<std::uint8_t>(code);
    const auto off = static_cast<double>(at) - static_cast<double>(code) / steps.scale;
    squares += off * off;
  }
  return static_cast<float>(std::sqrt(squares)) * (1 + kRounding) + numbers.rounding;
}

}  // namespace

DescriptorQuery::DescriptorQuery(const Descriptor& descriptor)
    : bins(simd::Padded(descriptor.size()), 0.0F) {
  std::ranges::copy(descriptor, bins.begin());
}

CodedNumbers NumbersToCode(const Descriptor& descriptor, const RootProjection* projection) {
  std::vector<float> roots(descriptor.size());
  std::ranges::transform(descriptor, roots.begin(), Root);
  if (projection != nullptr) {
    RootProjection::Projection projected = projection->Project(roots);
    return {std::move(projected.components), projected.rounding};
  }
  double squares = 0;
  for (const float root : roots) squares += static_cast<double>(root) * root;
  return {std::move(roots), kRootRounding * static_cast<float>(std::sqrt(squares))};
}

DescriptorChunk::DescriptorChunk(std::span<const IndexedView> views,
                                 std::shared_ptr<const RootProjection> projection)
    : projection_(std::move(projection)) {
  if (views.empty()) return;
  bins_ = views.front().descriptor.size();
  row_ = simd::Padded(bins_);
  rows_.assign(row_ * views.size(), 0);
  views_.reserve(views.size());
  rounded_off_.reserve(views.size());
  std::vector<CodedNumbers> numbers;
  numbers.reserve(views.size());
  float lowest = 0;
  float highest = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Descriptor& descriptor = views[i].descriptor;
    views_.push_back(views[i].view);
    std::ranges::copy(descriptor, rows_.begin() + static_cast<std::ptrdiff_t>(i * row_));
    numbers.push_back(NumbersToCode(descriptor, projection_.get()));
    const auto [low, high] = std::ranges::minmax(numbers.back().values);
    lowest = std::min(lowest, low);
    highest = std::max(highest, high);
  }
  if (highest > lowest) {
    lowest_ = lowest;
    scale_ = kLargestCode / (highest - lowest);
  }
  code_row_ = simd::PaddedBytes(numbers.front().values.size());
  codes_.assign(code_row_ * views.size(), 0);
  for (std::size_t i = 0; i < views.size(); ++i) {
    rounded_off_.push_back(Encode(numbers[i], {lowest_, scale_}, codes_.data() + i * code_row_));
  }
}

Descriptor DescriptorChunk::DescriptorOf(std::size_t i) const {
  const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(i * row_);
  return {begin, begin + static_cast<std::ptrdiff_t>(bins_)};
}

void DescriptorChunk::Bound(const CodedNumbers& coded, std::span<float> out) const {
  std::vector<std::uint8_t> code(code_row_, 0);
  const float query_off = Encode(coded, {lowest_, scale_}, code.data());
  std::vector<std::int32_t> squares(size());
  simd::Best().byte_distances(codes_.data(), code_row_, size(), code.data(), squares.data());
  const float step = (1 - kRounding) / scale_;
  for (std::size_t i = 0; i < size(); ++i) {
    const float between = std::sqrt(static_cast<float>(squares[i])) * step;
    const float bound = std::max(0.0F, between - query_off - rounded_off_[i]);
    out[i] = (1 - kRounding) * bound * bound;
  }
}

float DescriptorChunk::Distance(const DescriptorQuery& query, std::size_t i) const {
  return simd::Best().chi_square(query.bins.data(), rows_.data() + i * row_, row_);
}

}  // namespace graspdb::recognition
