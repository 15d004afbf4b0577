// Cameras of OpenNI 2 (PrimeSense Carmine, Asus Xtion and others with a driver for it), and its
// recordings.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

// Opens the device at `uri` (from ListOpenNi2; empty: any) or the recording at the path `uri`, and
// waits for its first frame. Frames are depth images in the camera's unit (1 mm or 0.1 mm), not
// mirrored and not registered to the colour camera, 640 x 480 if the device supports it, received
// on a thread of the sensor's own. The lens is assumed to be free of distortion, and the focal
// length follows from the field of view. A frame's time is two frames of a 30th second before its
// arrival; of a recording, its arrival.
//
// A recording plays at its own speed from the moment of opening on, and at its end is UNAVAILABLE,
// like an unplugged camera; with `loop` it starts again.
//
// UNAVAILABLE, with the next step, when the device is not connected or gives no frame within
// settings.silence; NOT_FOUND when a file *.oni does not exist; FAILED_PRECONDITION when the device
// has no depth camera, when neither it nor settings.intrinsics give the field of view, or when
// settings.intrinsics are for images of another size.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenOpenNi2(const std::string& uri, bool loop,
                                                         const SensorSettings& settings);

// The URIs of the connected devices. UNAVAILABLE when OpenNI cannot start.
absl::StatusOr<std::vector<std::string>> ListOpenNi2();

}  // namespace graspdb::client
