// The interface of depth cameras, and the settings of any kind of them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "files/messages/scan_message.h"
#include "program/base/monotonic_time.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// From the start of an exposure to the end of its transfer, for cameras without timestamps: the
// pattern is exposed for one frame of a 30th second and transferred during the next.
inline constexpr absl::Duration kExposureToArrival = absl::Milliseconds(66);

// One frame, in the sensor frame (x right, y down, z forward).
struct SensorFrame {
  // With intrinsics, and the capture time by this machine's wall clock.
  files::ScanMessage scan;
  // Start of its exposure; for cameras without timestamps a lower bound.
  MonotonicTime time = MonotonicTime::InfinitePast();
  // T_world_sensor, if the frame contains it, e.g. in a file's VIEWPOINT line.
  std::optional<recognition::Pose> world_sensor = {};
};

// A source of frames. Implementations are thread-safe.
class DepthSensor {
 public:
  virtual ~DepthSensor() = default;

  // A frame whose exposure started after the call, and so after the robot's previous motion.
  // UNAVAILABLE when the camera is not connected, with the next step in the message; a later call
  // may succeed, because the camera is reopened. DEADLINE_EXCEEDED when no frame came before
  // `deadline`. Other errors are permanent: the frames cannot be used.
  virtual absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) = 0;

  // Whether the camera delivers frames; does not wait for one.
  virtual bool IsReady() = 0;

  // Whether a recording has ended: no later call of Next returns a frame.
  virtual bool HasEnded() { return false; }

  // Display name, e.g. "Kinect v1 (libfreenect) no. 0".
  virtual std::string Name() const = 0;
};

// Sets `time` and the capture time of the scan, which is that moment by the wall clock of now.
void SetTime(MonotonicTime time, SensorFrame& frame);

// Returns the frames of another sensor if they are fresh. Thread-safe.
class FreshSensor : public DepthSensor {
 public:
  FreshSensor(std::unique_ptr<DepthSensor> sensor, absl::Duration max_age)
      : sensor_(std::move(sensor)), max_age_(max_age) {}

  // The errors of the sensor; UNAVAILABLE when the frame is older than the limit.
  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override;
  bool IsReady() override { return sensor_->IsReady(); }
  bool HasEnded() override { return sensor_->HasEnded(); }
  std::string Name() const override { return sensor_->Name(); }

 private:
  const std::unique_ptr<DepthSensor> sensor_;
  const absl::Duration max_age_;
};

struct SensorSettings {
  // Maximum age of a frame; an older one is an error.
  absl::Duration max_age = absl::Seconds(1);
  // Calibrated intrinsics; absent: those of the camera or its library. Not for files, which have
  // their own.
  std::optional<recognition::CameraIntrinsics> intrinsics = {};
  // A camera without a frame for this time counts as unplugged; also the limit for the first frame.
  absl::Duration silence = absl::Seconds(3);
  // Pause between attempts to open a missing camera, doubled after every attempt up to the longest.
  absl::Duration first_pause = absl::Milliseconds(250);
  absl::Duration max_pause = absl::Seconds(5);
};

// FAILED_PRECONDITION when intrinsics are given for another image size than that of `camera` (its
// display name). Thread-safe.
absl::Status CheckIntrinsics(const SensorSettings& settings, const std::string& camera, int width,
                             int height);

}  // namespace graspdb::client
