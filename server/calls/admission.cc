#include "server/calls/admission.h"

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/base/errors.h"

namespace graspdb::server {
namespace {
// How often a waiting call checks for cancellation.
constexpr absl::Duration kCancelPollInterval = absl::Milliseconds(20);
}  // namespace

Admission::Ticket::~Ticket() {
  if (admission_ == nullptr) return;
  absl::MutexLock lock(&admission_->mutex_);
  admission_->Release();
}

void Admission::Release() {
  if (queue_.empty()) {
    ++free_;
    return;
  }
  Waiter& next = *queue_.front();
  queue_.pop_front();
  next.has_slot = true;
  next.let_in.Signal();
}

bool Admission::Arrive(Waiter& waiter) {
  absl::MutexLock lock(&mutex_);
  if (free_ > 0) {
    --free_;
    waiter.has_slot = true;
    return true;
  }
  if (queue_.size() == places_) return false;
  queue_.push_back(&waiter);
  return true;
}

Admission::Use Admission::use() const {
  absl::MutexLock lock(&mutex_);
  return {.working = slots_ - free_, .slots = slots_, .waiting = queue_.size(), .places = places_};
}

bool Admission::Await(Waiter& waiter) {
  absl::MutexLock lock(&mutex_);
  if (!waiter.has_slot) waiter.let_in.WaitWithTimeout(&mutex_, kCancelPollInterval);
  return waiter.has_slot;
}

void Admission::Leave(Waiter& waiter) {
  absl::MutexLock lock(&mutex_);
  if (waiter.has_slot) {
    Release();
  } else {
    queue_.remove(&waiter);
  }
}

absl::StatusOr<Admission::Ticket> Admission::Enter(const std::function<bool()>& is_cancelled) {
  Waiter waiter;
  if (!Arrive(waiter)) {
    return TryAgainLater(
        WithReason(absl::ResourceExhaustedError(
                       "the server is busy and its queue is full; try again a little later"),
                   "QUEUE_FULL"));
  }
  for (bool has_slot = false; !has_slot;) {
    has_slot = Await(waiter);
    // Checked with a slot too: work for a cancelled call would delay others.
    if (!is_cancelled()) continue;
    Leave(waiter);
    return absl::CancelledError("the call was cancelled while it was waiting");
  }
  return Ticket(this);
}

}  // namespace graspdb::server
