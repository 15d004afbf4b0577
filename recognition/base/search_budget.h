// Search budget of one frame.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace graspdb::recognition {

// Hypotheses that a search may still screen for one cluster that its nearest views do not explain,
// and the deadline of the search. The count is deterministic for a frame and catalogue; the
// deadline is not. Not thread-safe.
class SearchBudget {
 public:
  using Clock = std::chrono::steady_clock;

  SearchBudget(std::size_t hypotheses, std::chrono::duration<double> ceiling)
      : SearchBudget(hypotheses,
                     Clock::now() + std::chrono::duration_cast<Clock::duration>(ceiling)) {}

  // False when nothing is left; `count` is then added to the untried views.
  bool Take(std::size_t count) {
    if (!out_of_time_ && count <= left_) {
      left_ -= count;
      return true;
    }
    untried_ += count;
    return false;
  }

  // Whether the deadline has passed; from then on nothing is left.
  bool OutOfTime() {
    out_of_time_ = out_of_time_ || Clock::now() > end_;
    return out_of_time_;
  }

  // One of `count` equal shares of the rest.
  SearchBudget Share(std::size_t count) const {
    return {left_ / std::max<std::size_t>(1, count), end_};
  }

  // Hypotheses that one search refines after the screening.
  static std::size_t refined() { return kRefined; }
  std::size_t left() const { return left_; }
  std::size_t untried() const { return untried_; }
  bool out_of_time() const { return out_of_time_; }

 private:
  // In 96 scenes with 40 % hidden, where descriptors are not distinctive, the final best was mostly
  // among the first ten after screening, and at most the 41st of up to 640. Doubled, unknown
  // objects take half as long again, and no more are found there.
  static constexpr std::size_t kRefined = 24;

  SearchBudget(std::size_t hypotheses, Clock::time_point end) : left_(hypotheses), end_(end) {}

  std::size_t left_;
  std::size_t untried_ = 0;
  Clock::time_point end_;
  bool out_of_time_ = false;
};

}  // namespace graspdb::recognition
