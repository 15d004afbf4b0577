// One scan of a scene that stands still, from several frames.
#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "recognition/base/types.h"

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

// Waits until the sensor is ready, as one that was just opened is not at once, or until `deadline`:
// the next frame says then what is wrong. Thread-safe, as all here.
void AwaitFrames(DepthSensor& sensor, absl::Time deadline);

// Takes `count` frames one after the other. Errors of the sensor.
absl::StatusOr<std::vector<SensorFrame>> TakeFrames(DepthSensor& sensor, int count,
                                                    absl::Time deadline);

// Averaged of TakeFrames. Errors of both.
absl::StatusOr<StillScan> TakeStillScan(DepthSensor& sensor, int count, absl::Time deadline);

}  // namespace graspdb::client
