// How much may be tried for one frame.
#pragma once

#include <chrono>
#include <cstddef>

namespace graspdb::recognition {

// Hypotheses that the search for what the nearest views do not explain may still screen, for all
// segments of a frame together, and the time until it ends in any case. What the count stops is
// the same for the same frame and catalogue; what the clock stops is not. Not thread-safe.
class SearchBudget {
 public:
  using Clock = std::chrono::steady_clock;

  SearchBudget(std::size_t hypotheses, std::chrono::duration<double> ceiling)
      : left_(hypotheses),
        end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(ceiling)) {}

  // False when nothing is left; `count` are then counted as not tried.
  bool Take(std::size_t count) {
    if (!out_of_time_ && count <= left_) {
      left_ -= count;
      return true;
    }
    untried_ += count;
    return false;
  }

  // Whether the ceiling has been reached; from then on nothing is left.
  bool OutOfTime() {
    out_of_time_ = out_of_time_ || Clock::now() > end_;
    return out_of_time_;
  }

  std::size_t untried() const { return untried_; }
  bool out_of_time() const { return out_of_time_; }

 private:
  std::size_t left_;
  std::size_t untried_ = 0;
  Clock::time_point end_;
  bool out_of_time_ = false;
};

}  // namespace graspdb::recognition
