// The first Kinect (Kinect for Xbox 360, model 1414 and variants) through libfreenect.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

// Opens a camera and waits for its first frame. `which` is its number (empty: 0) or the serial
// number of its camera. Frames are depth images, 640 x 480, in 0.1 mm, 30 a second, received on a
// thread of the sensor's own.
//
// The depths are computed from the raw 11-bit disparities, which are lossless and the only ones in
// recordings, with the calibration stored in the camera (see kinect_v1_calibration.h). The lens is
// assumed to be free of distortion. A frame's time is one frame before it began to arrive.
//
// UNAVAILABLE, with the next step, when the camera is not connected, is used by another program,
// may not be opened, or gives no frame within settings.silence; FAILED_PRECONDITION when the
// program runs on fakenect (see fakenect_recording.h) without a recording in $FAKENECT_PATH, or
// settings.intrinsics are not for 640 x 480. It must not be opened twice at once.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenFreenect(const std::string& which,
                                                          const SensorSettings& settings);

// The connected cameras, as names for OpenFreenect: serial numbers if the library provides them,
// else numbers. The errors of OpenFreenect when the library cannot start.
absl::StatusOr<std::vector<std::string>> ListFreenect();

}  // namespace graspdb::client
