// Averages several frames of a static scene.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"
#include "program/base/monotonic_time.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// Depths of a pixel that differ by more than this share of them belong to different surfaces.
inline constexpr float kSameSurfaceShare = 0.01F;

// Points in the sensor frame, metres; NaN: not measured.
struct StillScan {
  recognition::Points points;
  int width = 0;  // points in a row; 0: not organised
  // Of depth images: each point lies on the ray of its pixel.
  std::optional<recognition::CameraIntrinsics> camera = {};
};

// The points of one frame. INVALID_ARGUMENT for an invalid frame: inconsistent sizes, or clouds not
// packed as x, y, z floats.
absl::StatusOr<StillScan> ScanOf(const SensorFrame& frame);

// Per pixel, the mean of the measurements near the median, if at least half of the frames have one:
// removes flying pixels, which change from frame to frame, and reduces noise. Unorganised frames
// and frames of different sizes cannot be averaged: then the last one. Errors as ScanOf;
// INVALID_ARGUMENT without frames.
absl::StatusOr<StillScan> Averaged(std::span<const SensorFrame> frames);

// Waits until the sensor, e.g. just opened, is ready, or until `deadline`; then the next call of
// Next returns the error. Thread-safe, as all functions here.
void AwaitFrames(DepthSensor& sensor, MonotonicTime deadline);

// Takes `count` frames one after the other. Errors of the sensor.
absl::StatusOr<std::vector<SensorFrame>> TakeFrames(DepthSensor& sensor, int count,
                                                    MonotonicTime deadline);

// Averaged of TakeFrames. Errors of both.
absl::StatusOr<StillScan> TakeStillScan(DepthSensor& sensor, int count, MonotonicTime deadline);

}  // namespace graspdb::client
