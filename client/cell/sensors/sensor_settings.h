// What a cell wants of its depth camera, whatever kind it is.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "recognition/base/types.h"

namespace graspdb::client {

struct SensorSettings {
  // A frame that is older when it is handed out is an error and no answer.
  absl::Duration max_age = absl::Seconds(1);
  // The camera as it was calibrated; none: as the camera itself or its library says. Not for files,
  // which have it beside them.
  std::optional<recognition::CameraIntrinsics> intrinsics = {};
  // A camera that gives no frame for so long counts as unplugged. The first one may take as long.
  absl::Duration silence = absl::Seconds(3);
  // Between attempts to open a camera that is not there: the first pause, doubled after every
  // attempt up to the longest.
  absl::Duration first_pause = absl::Milliseconds(250);
  absl::Duration longest_pause = absl::Seconds(5);
};

// FAILED_PRECONDITION, with what to do, when intrinsics are given for images of another size than
// those of `camera`, as a person calls it. Thread-safe.
absl::Status CheckIntrinsics(const SensorSettings& settings, const std::string& camera, int width,
                             int height);

}  // namespace graspdb::client
