#include "program/base/latency_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace graspdb {
namespace {

// Bits of a time that are kept: 1024 buckets for every doubling, so that a bucket is at most a
// thousandth of its lower end wide.
constexpr int kKeptBits = 11;

// Bits of a time that its bucket drops.
int DroppedBits(std::int64_t ns) {
  return std::max(0, static_cast<int>(std::bit_width(static_cast<std::uint64_t>(ns))) - kKeptBits);
}

std::int64_t LowerEnd(std::int64_t ns) {
  const int dropped = DroppedBits(ns);
  return (ns >> dropped) << dropped;
}

// The longest time in the bucket that begins at `lower_end`.
std::int64_t UpperEnd(std::int64_t lower_end) {
  return lower_end + ((std::int64_t{1} << DroppedBits(lower_end)) - 1);
}

}  // namespace

void LatencyHistogram::Record(Duration time) {
  time = std::max(time, Duration::zero());
  min_ = count_ == 0 ? time : std::min(min_, time);
  max_ = std::max(max_, time);
  sum_ += time;
  ++count_;
  ++buckets_[LowerEnd(time.count())];
}

void LatencyHistogram::Merge(const LatencyHistogram& other) {
  if (other.count_ == 0) return;
  min_ = count_ == 0 ? other.min_ : std::min(min_, other.min_);
  max_ = std::max(max_, other.max_);
  sum_ += other.sum_;
  count_ += other.count_;
  for (const auto& [lower_end, count] : other.buckets_) buckets_[lower_end] += count;
}

LatencyHistogram::Duration LatencyHistogram::Mean() const {
  return count_ == 0 ? Duration::zero() : sum_ / count_;
}

LatencyHistogram::Duration LatencyHistogram::Percentile(double percent) const {
  const double share = std::clamp(percent, 0.0, 100.0) / 100;
  // 99.9 % of 1000 is 999, even if the product is slightly above it.
  const double rank = std::ceil(share * static_cast<double>(count_) - 1e-6);
  const std::int64_t wanted = std::max<std::int64_t>(1, static_cast<std::int64_t>(rank));
  std::int64_t seen = 0;
  for (const auto& [lower_end, count] : buckets_) {
    seen += count;
    if (seen >= wanted) return std::clamp(Duration(UpperEnd(lower_end)), min_, max_);
  }
  return max_;
}

std::int64_t LatencyHistogram::CountBelow(Duration time) const {
  std::int64_t out = 0;
  for (const auto& [lower_end, count] : buckets_) {
    if (lower_end >= time.count()) break;
    out += count;
  }
  return out;
}

}  // namespace graspdb
