// Events that may come in any number, such as refusals, and are logged as often as is readable.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

namespace graspdb {

// Counts events for one line of the log a second. Thread-safe.
class LogInterval {
 public:
  // Counts an event. How many there were since the last line, if a line is due.
  std::optional<std::int64_t> Count() {
    const std::scoped_lock lock(mutex_);
    ++count_;
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return std::nullopt;
    next_ = now + std::chrono::seconds(1);
    return std::exchange(count_, 0);
  }

 private:
  std::mutex mutex_;
  std::int64_t count_ = 0;
  std::chrono::steady_clock::time_point next_;  // the first line is immediate
};

}  // namespace graspdb
