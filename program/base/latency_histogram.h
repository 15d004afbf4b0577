// A histogram of durations from which any percentile can be computed.
//
// After G. Tene's HdrHistogram (http://hdrhistogram.org): buckets that are narrow for short times
// and wide for long ones, so that every time is known to three significant digits. There is no
// package of its C library in Debian 12.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>

namespace graspdb {

// Times from a nanosecond to centuries, each within 0.1 % of the recorded value; minimum, maximum
// and sum are exact. Not thread-safe: use one per thread and merge.
class LatencyHistogram {
 public:
  using Duration = std::chrono::nanoseconds;

  // Negative times, which a clock that was set back may give, count as zero.
  void Record(Duration time);
  // Adds all durations that were recorded in `other`.
  void Merge(const LatencyHistogram& other);

  std::int64_t count() const { return count_; }
  // Zero if empty; so are all the following.
  Duration Min() const { return min_; }
  Duration Max() const { return max_; }
  Duration Sum() const { return sum_; }
  Duration Mean() const;
  // The time that `percent` of all (0 to 100) did not exceed: the nearest rank, as the upper end of
  // its bucket.
  Duration Percentile(double percent) const;

  // Number of times below `time`, to the width of a bucket.
  std::int64_t CountBelow(Duration time) const;

 private:
  std::map<std::int64_t, std::int64_t> buckets_;  // by their lower end, ns; only those with a count
  std::int64_t count_ = 0;
  Duration min_{0};
  Duration max_{0};
  Duration sum_{0};
};

}  // namespace graspdb
