// Rate of an upload.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>

#include "absl/time/time.h"

namespace graspdb::server {

// Counts views over the last half minute. Not thread-safe; times must not decrease.
class UploadRate {
 public:
  void Add(absl::Time now) {
    if (counts_.empty() || now - counts_.back().since >= kStep) counts_.push_back({now, 0});
    ++counts_.back().views;
    Forget(now);
  }

  double PerSecond(absl::Time now) {
    Forget(now);
    std::int64_t views = 0;
    for (const Count& count : counts_) views += count.views;
    if (views == 0) return 0;
    return static_cast<double>(views) /
           absl::ToDoubleSeconds(std::max(kStep, now - counts_.front().since));
  }

 private:
  static constexpr absl::Duration kStep = absl::Seconds(1);
  // Doubled, the rate follows a change more slowly.
  static constexpr absl::Duration kSpan = absl::Seconds(30);

  struct Count {
    absl::Time since;
    std::int64_t views;
  };

  void Forget(absl::Time now) {
    while (!counts_.empty() && now - counts_.front().since > kSpan) counts_.pop_front();
  }

  std::deque<Count> counts_;  // of a step each
};

}  // namespace graspdb::server
