#include "client/cell/sensors/frame_mailbox.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"

namespace graspdb::client {

FrameMailbox::FrameMailbox(absl::Duration silence, std::string advice)
    : silence_(silence), advice_(std::move(advice)), last_(MonotonicTime::Now()) {}

void FrameMailbox::Put(SensorFrame frame) {
  auto newest = std::make_shared<const SensorFrame>(std::move(frame));
  const absl::MutexLock lock(&mutex_);
  newest_.swap(newest);  // the old frame is freed after the lock
  last_ = MonotonicTime::Now();
  changed_.SignalAll();
}

void FrameMailbox::Fail(absl::Status why) {
  const absl::MutexLock lock(&mutex_);
  if (why_.ok()) why_ = std::move(why);
  changed_.SignalAll();
}

absl::Status FrameMailbox::Silent() const {
  return absl::UnavailableError(
      absl::StrCat("no frame from the camera for ", absl::FormatDuration(silence_), "; ", advice_));
}

absl::StatusOr<SensorFrame> FrameMailbox::Wait(MonotonicTime after, MonotonicTime deadline) {
  std::shared_ptr<const SensorFrame> found;
  {
    const absl::MutexLock lock(&mutex_);
    while (newest_ == nullptr || newest_->time < after) {
      const MonotonicTime now = MonotonicTime::Now();
      if (!why_.ok()) return why_;
      if (now >= GoneAt()) return Silent();
      if (now >= deadline) {
        return absl::DeadlineExceededError("no frame came in time; use a later deadline");
      }
      changed_.WaitUntil(&mutex_, std::min(deadline, GoneAt()));
    }
    found = newest_;
  }
  return *found;
}

bool FrameMailbox::IsAlive() const {
  const absl::MutexLock lock(&mutex_);
  return why_.ok() && MonotonicTime::Now() < GoneAt();
}

}  // namespace graspdb::client
