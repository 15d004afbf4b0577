// Cameras of OpenNI 2 (PrimeSense Carmine, Asus Xtion and others with a driver for it), and its
// recordings.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/sensor_settings.h"

namespace graspdb::client {

// Opens the device at `uri` (as ListOpenNi2 says it; empty: any) or the recording at the path
// `uri`, and waits for its first frame. Frames are depth images in the camera's unit (1 mm or
// 0.1 mm), not mirrored and not moved to the colour camera, 640 x 480 where the device can,
// received on a thread of the sensor's own. The lens is taken as free of distortion, and the focal
// length from the field of view. A frame's time is two frames of a 30th second before its arrival;
// of a recording, its arrival.
//
// A recording plays at its own speed from the moment of opening on, and at its end is UNAVAILABLE,
// as an unplugged camera; with `loop` it begins again.
//
// UNAVAILABLE, with what to do, when the device is not there or gives no frame within
// settings.silence; NOT_FOUND when a file *.oni is not there; FAILED_PRECONDITION when it has no
// depth camera or does not say its field of view, and settings.intrinsics does neither, or is for
// images of another size.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenOpenNi2(const std::string& uri, bool loop,
                                                         const SensorSettings& settings);

// The URIs of the devices that are connected now. UNAVAILABLE when OpenNI cannot start.
absl::StatusOr<std::vector<std::string>> ListOpenNi2();

}  // namespace graspdb::client
