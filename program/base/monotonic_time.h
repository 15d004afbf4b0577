// Times of a clock that is never set.
#pragma once

#include <chrono>
#include <compare>

#include "absl/time/time.h"

namespace graspdb {

// A moment of the monotonic clock, for deadlines and ages. absl::Time, for times that are shown or
// stored, follows the wall clock: set ahead by an hour, it ends all waits at once; set back, it
// makes them an hour longer. Has no meaning outside of this process.
class MonotonicTime {
 public:
  static MonotonicTime Now() { return MonotonicTime(std::chrono::steady_clock::now()); }
  static constexpr MonotonicTime InfinitePast() { return MonotonicTime(-absl::InfiniteDuration()); }
  static constexpr MonotonicTime InfiniteFuture() {
    return MonotonicTime(absl::InfiniteDuration());
  }

  friend MonotonicTime operator+(MonotonicTime time, absl::Duration duration) {
    return MonotonicTime(time.of_clock_ + duration);
  }
  friend MonotonicTime operator-(MonotonicTime time, absl::Duration duration) {
    return MonotonicTime(time.of_clock_ - duration);
  }
  friend absl::Duration operator-(MonotonicTime a, MonotonicTime b) {
    return a.of_clock_ - b.of_clock_;
  }
  friend constexpr bool operator==(MonotonicTime a, MonotonicTime b) {
    return a.of_clock_ == b.of_clock_;
  }
  friend constexpr std::strong_ordering operator<=>(MonotonicTime a, MonotonicTime b) {
    if (a.of_clock_ < b.of_clock_) return std::strong_ordering::less;
    return a == b ? std::strong_ordering::equal : std::strong_ordering::greater;
  }

  // The nearest time for infinite ones.
  std::chrono::steady_clock::time_point ToChrono() const {
    return std::chrono::steady_clock::time_point(absl::ToChronoNanoseconds(of_clock_));
  }

 private:
  explicit MonotonicTime(std::chrono::steady_clock::time_point time)
      : of_clock_(absl::FromChrono(time.time_since_epoch())) {}
  explicit constexpr MonotonicTime(absl::Duration of_clock) : of_clock_(of_clock) {}

  absl::Duration of_clock_;  // since the clock's epoch
};

}  // namespace graspdb
