// Cancellation of work whose result is no longer needed.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>

namespace graspdb::recognition {

// Whether the caller no longer needs the result. Once true, it stays true.
using IsCancelled = std::function<bool()>;

// Does not call `is_cancelled`, which must outlive it, again after it returned true. Thread-safe;
// calls it from one thread at a time.
inline IsCancelled Latched(const IsCancelled& is_cancelled) {
  struct State {
    std::mutex mutex;
    bool cancelled = false;
  };
  return [&is_cancelled, state = std::make_shared<State>()] {
    const std::lock_guard lock(state->mutex);
    return state->cancelled = state->cancelled || (is_cancelled && is_cancelled());
  };
}

// Counts what a loop has done and polls IsCancelled about once a millisecond. Not thread-safe; the
// function must outlive it.
class CancellationPoll {
 public:
  explicit CancellationPoll(const IsCancelled& is_cancelled) : is_cancelled_(is_cancelled) {}

  // Adds distances between points, of a nanosecond each. True when the loop should end.
  bool AfterDistances(std::size_t count) {
    work_ += count;
    return work_ < kInterval ? cancelled_ : Now();
  }
  // Adds points or cells, of about 100 ns each.
  bool AfterPoints(std::size_t count = 1) { return AfterDistances(100 * count); }
  // Polls now.
  bool Now() {
    if (cancelled_) return true;
    work_ = 0;
    cancelled_ = is_cancelled_ && is_cancelled_();
    return cancelled_;
  }

 private:
  // About 1 ms; a call returns within 20 ms even where a step takes ten times as long.
  static constexpr std::size_t kInterval = 1'000'000;

  const IsCancelled& is_cancelled_;
  std::size_t work_ = 0;
  bool cancelled_ = false;
};

}  // namespace graspdb::recognition
