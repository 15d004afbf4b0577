// Durations, counted so that any percentile can be told afterwards.
//
// After G. Tene's HdrHistogram (http://hdrhistogram.org): buckets that are narrow for short times
// and wide for long ones, so that every time is known to three significant digits. There is no
// package of its C library in Debian 12.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>

namespace graspdb::client {

// Times from a nanosecond to centuries, each within 0.1 % of what was recorded; the least, the
// greatest and the sum are exact. Not thread-safe: count apart and merge.
class LatencyHistogram {
 public:
  using Duration = std::chrono::nanoseconds;

  // Times below zero, which a clock that was set back may show, count as zero.
  void Record(Duration time);
  // As if everything that `other` has heard of had been recorded here too.
  void Merge(const LatencyHistogram& other);

  std::int64_t count() const { return count_; }
  // Zero when nothing was recorded; so are all the following.
  Duration Min() const { return min_; }
  Duration Max() const { return max_; }
  Duration Sum() const { return sum_; }
  Duration Mean() const;
  // The time that `percent` of all (0 to 100) did not exceed: of the nearest rank, and rather the
  // upper end of its bucket than the lower.
  Duration Percentile(double percent) const;

  // How many took less than `time`, to the width of a bucket.
  std::int64_t CountBelow(Duration time) const;

 private:
  std::map<std::int64_t, std::int64_t> buckets_;  // by their lower end, ns; only those with a count
  std::int64_t count_ = 0;
  Duration min_{0};
  Duration max_{0};
  Duration sum_{0};
};

}  // namespace graspdb::client
