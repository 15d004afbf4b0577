// Settings for depth cameras of any kind.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "recognition/base/types.h"

namespace graspdb::client {

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
