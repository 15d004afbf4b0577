// How many calls compute at once, how many wait, and who is turned away.
#pragma once

#include <functional>
#include <memory>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"

namespace graspdb::server {

// `slots` callers work at a time and `waiting` more may wait. Thread-safe.
class Admission {
 public:
  // Gives its slot back when it goes.
  class Ticket {
   public:
    explicit Ticket(Admission* admission) : admission_(admission) {}
    ~Ticket();
    Ticket(Ticket&& other) noexcept : admission_(other.admission_) { other.admission_ = nullptr; }
    Ticket& operator=(Ticket&&) = delete;

   private:
    Admission* admission_;
  };

  Admission(int slots, int waiting) : free_(slots), places_(waiting) {}

  // Waits for a slot. RESOURCE_EXHAUSTED when too many wait already; CANCELLED when
  // `is_cancelled` says so while waiting.
  absl::StatusOr<Ticket> Enter(const std::function<bool()>& is_cancelled);

 private:
  absl::Mutex mutex_;
  absl::CondVar freed_;
  int free_ ABSL_GUARDED_BY(mutex_);
  int places_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::server
