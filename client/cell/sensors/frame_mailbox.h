// Passes frames from a camera's thread to waiting threads.
#pragma once

#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "program/base/monotonic_cond_var.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

// Keeps the newest frame. Thread-safe.
class FrameMailbox {
 public:
  // After `silence` without a frame, starting now, the camera counts as disconnected. `advice`:
  // what to do then, the end of a sentence.
  explicit FrameMailbox(absl::Duration silence,
                        std::string advice = "check its cable and its power supply");

  // Stores a new frame, with its time set.
  void Put(SensorFrame frame) ABSL_LOCKS_EXCLUDED(mutex_);
  // No more frames will come. The first error is kept.
  void Fail(absl::Status why) ABSL_LOCKS_EXCLUDED(mutex_);

  // A frame whose time is not before `after`. The error of Fail; UNAVAILABLE after the silence;
  // DEADLINE_EXCEEDED.
  absl::StatusOr<SensorFrame> Wait(MonotonicTime after, MonotonicTime deadline)
      ABSL_LOCKS_EXCLUDED(mutex_);

  // Neither failed nor silent.
  bool IsAlive() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  MonotonicTime GoneAt() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return last_ + silence_; }
  absl::Status Silent() const;

  const absl::Duration silence_;
  const std::string advice_;
  mutable absl::Mutex mutex_;
  MonotonicCondVar changed_;
  std::shared_ptr<const SensorFrame> newest_ ABSL_GUARDED_BY(mutex_);
  MonotonicTime last_ ABSL_GUARDED_BY(mutex_);  // arrival of the last frame, or construction
  absl::Status why_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
