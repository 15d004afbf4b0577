// The first Kinect (Kinect for Xbox 360, model 1414 and its sisters) through libfreenect.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/sensor_settings.h"

namespace graspdb::client {

// Opens a camera and waits for its first frame. `which` is its number (empty: 0) or the serial
// number of its camera. Frames are depth images, 640 x 480, in 0.1 mm, 30 a second, received on a
// thread of the sensor's own.
//
// The depths are computed from the raw 11-bit disparities, which lose nothing, are the only ones
// that recordings have, and by the camera's own calibration, which it tells (see
// kinect_v1_calibration.h). The lens is taken as free of distortion. A frame's time is one frame
// before it began to arrive.
//
// UNAVAILABLE, with what to do, when the camera is not there, is used by another program, may not
// be opened, or gives no frame within settings.silence; FAILED_PRECONDITION when the program runs
// on fakenect (see fakenect_recording.h) without a recording in $FAKENECT_PATH, or
// settings.intrinsics are not for 640 x 480. It must not be opened twice at once.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenFreenect(const std::string& which,
                                                          const SensorSettings& settings);

// What OpenFreenect calls the cameras that are connected now: serial numbers where the library
// tells them, else numbers. The errors of OpenFreenect where the library cannot start.
absl::StatusOr<std::vector<std::string>> ListFreenect();

}  // namespace graspdb::client
