// Limits how many calls compute at once and how many wait; more are rejected.
#pragma once

#include <cstddef>
#include <functional>
#include <list>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"

namespace graspdb::server {

// `slots` callers work at a time and `waiting` more may wait, first come, first served.
// Thread-safe.
class Admission {
 public:
  // Releases its slot when destroyed.
  class Ticket {
   public:
    explicit Ticket(Admission* admission) : admission_(admission) {}
    ~Ticket();
    Ticket(Ticket&& other) noexcept : admission_(other.admission_) { other.admission_ = nullptr; }
    Ticket& operator=(Ticket&&) = delete;

   private:
    Admission* admission_;
  };

  struct Use {
    int working = 0;
    int slots = 0;
    std::size_t waiting = 0;
    std::size_t places = 0;
  };

  Admission(int slots, int waiting)
      : slots_(slots), places_(static_cast<std::size_t>(waiting)), free_(slots) {}

  // Waits for a slot. RESOURCE_EXHAUSTED when too many wait already; CANCELLED when
  // `is_cancelled`, which is called outside of all locks, returns true while waiting or once a slot
  // is free.
  absl::StatusOr<Ticket> Enter(const std::function<bool()>& is_cancelled);

  Use use() const;

 private:
  // A caller in the queue, on its own stack.
  struct Waiter {
    absl::CondVar let_in;
    bool has_slot = false;
  };

  // Takes a slot or a place in the queue; false for neither.
  bool Arrive(Waiter& waiter);
  // Waits until the waiter has a slot and has left the queue (true), or for a while.
  bool Await(Waiter& waiter);
  // Removes a cancelled waiter from the queue, or gives its slot to the next.
  void Leave(Waiter& waiter);
  // Gives a slot to the caller that has waited longest.
  void Release() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const int slots_;
  const std::size_t places_;
  mutable absl::Mutex mutex_;
  int free_ ABSL_GUARDED_BY(mutex_);                  // 0 while a caller waits
  std::list<Waiter*> queue_ ABSL_GUARDED_BY(mutex_);  // first come, first in the list
};

}  // namespace graspdb::server
