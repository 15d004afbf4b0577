// Rate of an upload.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>

namespace graspdb::server {

// Counts views over the last half minute. Not thread-safe.
class UploadRate {
 public:
  using Clock = std::chrono::steady_clock;

  void Add(Clock::time_point now) {
    if (counts_.empty() || now - counts_.back().since >= kStep) counts_.push_back({now, 0});
    ++counts_.back().views;
    Forget(now);
  }

  double PerSecond(Clock::time_point now) {
    Forget(now);
    std::int64_t views = 0;
    for (const Count& count : counts_) views += count.views;
    if (views == 0) return 0;
    return static_cast<double>(views) /
           std::chrono::duration<double>(
               std::max<Clock::duration>(kStep, now - counts_.front().since))
               .count();
  }

 private:
  static constexpr std::chrono::seconds kStep{1};
  static constexpr std::chrono::seconds kSpan{30};

  struct Count {
    Clock::time_point since;
    std::int64_t views;
  };

  void Forget(Clock::time_point now) {
    while (!counts_.empty() && now - counts_.front().since > kSpan) counts_.pop_front();
  }

  std::deque<Count> counts_;  // of a step each
};

}  // namespace graspdb::server
