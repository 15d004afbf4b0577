// Ends a thread that waits most of the time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace graspdb {

// Thread-safe. Its waits follow the monotonic clock. Those of absl::Mutex follow the wall clock:
// set back by an hour, they would take an hour longer.
class StopFlag {
 public:
  void Raise() {
    const std::scoped_lock lock(mutex_);
    raised_ = true;
    changed_.notify_all();
  }

  // Waits for a time, or until the flag is raised; true if it is.
  bool Wait(std::chrono::nanoseconds time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, time, [this] { return raised_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool raised_ = false;
};

}  // namespace graspdb
