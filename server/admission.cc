#include "server/admission.h"

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/errors.h"

namespace graspdb::server {
namespace {
// How often a waiting caller looks whether it is still wanted.
constexpr absl::Duration kPatience = absl::Milliseconds(20);
}  // namespace

Admission::Ticket::~Ticket() {
  if (admission_ == nullptr) return;
  absl::MutexLock lock(&admission_->mutex_);
  ++admission_->free_;
  admission_->freed_.Signal();
}

absl::StatusOr<Admission::Ticket> Admission::Enter(const std::function<bool()>& is_cancelled) {
  absl::MutexLock lock(&mutex_);
  if (free_ == 0) {
    if (places_ == 0) {
      return WithReason(absl::ResourceExhaustedError(
                            "the server is busy and its queue is full; try again a little later"),
                        "QUEUE_FULL");
    }
    --places_;
    bool cancelled = false;
    while (free_ == 0 && !cancelled) {
      freed_.WaitWithTimeout(&mutex_, kPatience);
      cancelled = free_ == 0 && is_cancelled();
    }
    ++places_;
    if (cancelled) return absl::CancelledError("the caller left while it was waiting");
  }
  --free_;
  return Ticket(this);
}

}  // namespace graspdb::server
