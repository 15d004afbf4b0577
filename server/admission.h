// How many calls compute at once, how many wait, and who is turned away.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"

namespace graspdb::server {

// `slots` callers work at a time and `waiting` more may wait; who came first is let in first.
// Thread-safe.
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

  Admission(int slots, int waiting) : free_(slots), places_(static_cast<std::size_t>(waiting)) {}

  // Waits for a slot. RESOURCE_EXHAUSTED when too many wait already; CANCELLED when
  // `is_cancelled`, which is asked outside of all locks, says so while waiting or when a slot is
  // there.
  absl::StatusOr<Ticket> Enter(const std::function<bool()>& is_cancelled);

 private:
  // A caller in the queue, on its own stack.
  struct Waiter {
    absl::CondVar let_in;
    bool has_slot = false;
  };

  // Takes a slot or a place in the queue; false for neither.
  bool Arrive(Waiter& waiter);
  // Until the waiter has a slot (true), which it is taken out of the queue for, or for a while.
  bool Await(Waiter& waiter);
  // Takes a waiter that has left out of the queue, or gives its slot to the next.
  void Leave(Waiter& waiter);
  // Gives a slot to who waits the longest.
  void Release() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  absl::Mutex mutex_;
  int free_ ABSL_GUARDED_BY(mutex_);  // none while anybody waits
  const std::size_t places_;
  std::list<Waiter*> queue_ ABSL_GUARDED_BY(mutex_);  // who came first in front
};

}  // namespace graspdb::server
