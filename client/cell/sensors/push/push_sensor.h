// Cameras whose frames another program pushes, with the SDK of their vendor.
#pragma once

#include <memory>
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

// Age of a frame; an older one shows clocks that differ, or another unit.
inline constexpr absl::Duration kMaxPushedAge = absl::Minutes(1);

// The frame of a request, which is untrusted and came at `arrival` by the wall clock and `now` by
// the monotonic one. Clouds are repacked as x, y, z floats, as the rest of the agent reads them;
// takes no more memory than the request. INVALID_ARGUMENT with the field: no name, no scan, wrong
// sizes, strides, fields, intrinsics or depth unit, a time that is missing, in the future or older
// than kMaxPushedAge, coordinates that can only be millimetres. A frame without a measurement is
// valid. Thread-safe.
absl::StatusOr<SensorFrame> PushedFrame(const v1::PushFrameRequest& request, absl::Time arrival,
                                        MonotonicTime now);

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

// A gRPC server with graspdb.v1.FrameService.
class PushSensor : public DepthSensor {
 public:
  // Listens at once. `where`: PORT, on this machine only, or HOST:PORT; port 0 picks one.
  // `allow_remote`: other machines may push, without encryption or password. INVALID_ARGUMENT for
  // another `where`; FAILED_PRECONDITION when other machines could push without allow_remote, and
  // when it cannot listen there.
  static absl::StatusOr<std::unique_ptr<PushSensor>> Listen(const std::string& where,
                                                            bool allow_remote,
                                                            const SensorSettings& settings);
  // No call of Next may be in progress.
  ~PushSensor() override;
  PushSensor(const PushSensor&) = delete;
  PushSensor& operator=(const PushSensor&) = delete;

  // UNAVAILABLE at once where no frame has come for settings.silence.
  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override;
  bool IsReady() override;
  std::string Name() const override;

  // HOST:PORT with the actual port.
  const std::string& address() const;

 private:
  class Server;
  explicit PushSensor(std::unique_ptr<Server> server);
  const std::unique_ptr<Server> server_;
};

}  // namespace graspdb::client
