// Receives the frames that another program pushes.
#pragma once

#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/frame_mailbox.h"
#include "graspdb/v1/frame_service.pb.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

// Keeps the newest frame of one camera. Thread-safe.
class FrameReceiver {
 public:
  // After `silence` without a frame of the camera, another one may take its place. `advice`: what
  // to do then.
  FrameReceiver(absl::Duration silence, std::string advice);

  // Keeps the frame of a request that came at `arrival` by the wall clock and `now` by the
  // monotonic one. `peer` is for the log. The errors of PushedFrame; FAILED_PRECONDITION while
  // frames of another camera come; ABORTED when a newer frame came before.
  absl::Status Receive(const v1::PushFrameRequest& request, const std::string& peer,
                       absl::Time arrival, MonotonicTime now) ABSL_LOCKS_EXCLUDED(mutex_);

  // As FrameMailbox::Wait.
  absl::StatusOr<SensorFrame> Wait(MonotonicTime after, MonotonicTime deadline) {
    return frames_.Wait(after, deadline);
  }

  // Whether frames come.
  bool IsReady() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  const absl::Duration silence_;
  FrameMailbox frames_;
  mutable absl::Mutex mutex_;
  std::string camera_ ABSL_GUARDED_BY(mutex_);                                    // empty: none yet
  MonotonicTime last_ ABSL_GUARDED_BY(mutex_) = MonotonicTime::InfinitePast();    // its arrival
  MonotonicTime newest_ ABSL_GUARDED_BY(mutex_) = MonotonicTime::InfinitePast();  // its exposure
};

}  // namespace graspdb::client
