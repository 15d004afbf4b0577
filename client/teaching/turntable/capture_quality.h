// Capture quality of an object in camera frames.
#pragma once

#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

struct CaptureQuality {
  int point_count = 0;  // of the object
  // The other values exist only for depth images, whose pixels are known.
  bool of_image = false;
  // Share of the pixels between the outermost ones of the object in each row that have a depth:
  // less than 1 where it is black, glossy or transparent.
  double measured_share = 1;
  // Share of the object's pixels whose depth differs by more than 1 % from frame to frame: edges,
  // and most pixels of a moving object.
  double moving_share = 0;
  // Standard deviation of the object's depths from frame to frame, m: the median of its pixels. 0
  // for a single frame.
  double noise_m = 0;
};

// For the object with these points (sensor frame, m) in frames of one stationary camera.
// Errors as ScanOf; INVALID_ARGUMENT without frames.
absl::StatusOr<CaptureQuality> CaptureQualityOf(std::span<const SensorFrame> frames,
                                                const recognition::Points& object);

// "1204 points, 97 % of its outline measured, depths within 1.2 mm".
std::string CaptureQualityText(const CaptureQuality& quality);

}  // namespace graspdb::client
