// One scan of a scene that stands still, from several frames.
#pragma once

#include <span>

#include "absl/status/statusor.h"
#include "client/sensors/depth_sensor.h"
#include "recognition/types.h"

namespace graspdb::client {

// Points in the sensor frame, metres; NaN where nothing was measured.
struct StillScan {
  recognition::Points points;
  int width = 0;  // points in a row; 0: not organised
};

// The points of one frame. INVALID_ARGUMENT when the frame is none: sizes that do not fit, or
// clouds packed in another way than x, y, z floats.
absl::StatusOr<StillScan> ScanOf(const SensorFrame& frame);

// Pixel by pixel the mean of what lies near the median, where at least half of the frames measured
// something: flying pixels, which are elsewhere in every frame, are gone, and the noise is less.
// Frames that are not organised, or of different sizes, cannot be laid on each other: then the last
// one. Errors as ScanOf; INVALID_ARGUMENT without frames.
absl::StatusOr<StillScan> Averaged(std::span<const SensorFrame> frames);

// Takes `count` frames one after the other. Errors of the sensor, and of Averaged.
absl::StatusOr<StillScan> TakeStillScan(DepthSensor& sensor, int count, absl::Time deadline);

}  // namespace graspdb::client
