// The largest scores of a search so far.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace graspdb::recognition {

// The minimum score to be among the `count` largest and at least `share` of the largest one.
class TopScores {
 public:
  TopScores(std::size_t count, double share) : count_(count), share_(share) {}

  // Lower scores are excluded. Never falls.
  double min() const {
    return std::max(share_ * largest_, heap_.size() < count_ ? 0 : heap_.front());
  }

  // O(log count).
  void Add(double score) {
    largest_ = std::max(largest_, score);
    heap_.push_back(score);
    std::ranges::push_heap(heap_, std::greater());
    if (heap_.size() <= count_) return;
    std::ranges::pop_heap(heap_, std::greater());
    heap_.pop_back();
  }

 private:
  std::size_t count_;
  double share_;
  double largest_ = 0;
  std::vector<double> heap_;  // the smallest in front
};

}  // namespace graspdb::recognition
