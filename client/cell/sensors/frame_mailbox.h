// Between a camera's thread and those who wait for frames.
#pragma once

#include <memory>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

// Keeps the newest frame. Thread-safe.
class FrameMailbox {
 public:
  // Without a frame for `silence` the camera counts as gone, from now on.
  explicit FrameMailbox(absl::Duration silence);

  // A frame came, with its time.
  void Put(SensorFrame frame) ABSL_LOCKS_EXCLUDED(mutex_);
  // No more frames will come. The first reason stays.
  void Fail(absl::Status why) ABSL_LOCKS_EXCLUDED(mutex_);

  // A frame whose time is not before `after`. The reason of Fail; UNAVAILABLE after the silence;
  // DEADLINE_EXCEEDED.
  absl::StatusOr<SensorFrame> Wait(absl::Time after, absl::Time deadline)
      ABSL_LOCKS_EXCLUDED(mutex_);

  // Neither failed nor silent.
  bool IsAlive() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  absl::Time GoneAt() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return last_ + silence_; }
  absl::Status Silent() const;

  const absl::Duration silence_;
  mutable absl::Mutex mutex_;
  absl::CondVar changed_;
  std::shared_ptr<const SensorFrame> newest_ ABSL_GUARDED_BY(mutex_);
  absl::Time last_ ABSL_GUARDED_BY(mutex_);  // when a frame came; at first the beginning
  absl::Status why_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
