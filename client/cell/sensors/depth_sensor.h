// Depth cameras, whatever they are: one small interface.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// From the beginning of an exposure to the end of its transfer, for a camera that does not give the
// time: the pattern is exposed for one frame of a 30th second and transferred during the next.
inline constexpr absl::Duration kExposureToArrival = absl::Milliseconds(66);

// One frame, in the sensor frame (x right, y down, z forward).
struct SensorFrame {
  // With the intrinsics and the time of capture.
  std::variant<v1::DepthImage, v1::PointCloud> scan;
  // When its exposure began, by this machine's clock; no later than that, where the camera does not
  // say it.
  absl::Time time = absl::InfinitePast();
  // T_world_sensor, where the frame itself says it, as a file's VIEWPOINT line does.
  std::optional<recognition::Pose> world_sensor = {};
};

// Gives frames. Implementations are thread-safe.
class DepthSensor {
 public:
  virtual ~DepthSensor() = default;

  // A frame whose exposure began after the call, so that what the robot did before is seen.
  // UNAVAILABLE when the camera is not there (any more), with what to do about it: a later call may
  // succeed, for it is looked for again. DEADLINE_EXCEEDED when none came before `deadline`. Other
  // errors: what it gives cannot be used, and will not be.
  virtual absl::StatusOr<SensorFrame> Next(absl::Time deadline) = 0;

  // Whether frames come, without waiting for one.
  virtual bool IsReady() = 0;

  // Whether it is a recording at its end: no later call of Next gives a frame.
  virtual bool HasEnded() { return false; }

  // What a person calls it, e.g. "Kinect v1 (libfreenect) no. 0".
  virtual std::string Name() const = 0;
};

// Writes `time` into the scan too, as its time of capture.
void SetTime(absl::Time time, SensorFrame& frame);

}  // namespace graspdb::client
