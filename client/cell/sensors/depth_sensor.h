// The interface of depth cameras.
#pragma once

#include <optional>
#include <string>

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

}  // namespace graspdb::client
