// Waits that do not follow the wall clock.
#pragma once

#include <condition_variable>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "program/base/monotonic_time.h"

namespace graspdb {

// As absl::CondVar, but with the monotonic clock. absl's own waits follow the wall clock, also
// those for a duration: set back by an hour while they last, they take an hour longer.
class MonotonicCondVar {
 public:
  // The caller holds the mutex, which is free during the wait. May return without a reason.
  void Wait(absl::Mutex* mutex) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex) {
    Held held{mutex};
    changed_.wait(held);
  }
  // The same until a deadline; true if it has passed.
  bool WaitUntil(absl::Mutex* mutex, MonotonicTime deadline) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex) {
    Held held{mutex};
    return changed_.wait_until(held, deadline.ToChrono()) == std::cv_status::timeout;
  }

  void SignalAll() { changed_.notify_all(); }

 private:
  // The mutex with the functions that the standard library calls.
  struct Held {
    void lock() ABSL_NO_THREAD_SAFETY_ANALYSIS { mutex->Lock(); }
    void unlock() ABSL_NO_THREAD_SAFETY_ANALYSIS { mutex->Unlock(); }
    absl::Mutex* mutex;
  };

  std::condition_variable_any changed_;
};

}  // namespace graspdb
