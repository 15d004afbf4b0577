// The second Kinect (Kinect for Xbox One, for Windows v2) through libfreenect2. Built only where
// that library is installed, which Debian 12 does not have: see docs/sensors.md.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/sensor_settings.h"

namespace graspdb::client {

inline constexpr int kKinectV2Width = 512;
inline constexpr int kKinectV2Height = 424;

// Opens the camera with the serial number `serial` (empty: the first) and waits for its first
// frame. Frames are depth images, 512 x 424, in 0.1 mm, with the camera's own intrinsics, where the
// settings have none, and its lens's distortion taken off, 30 a second. The decoder is that which
// $LIBFREENECT2_PIPELINE names (cpu, gl, cl, cuda) or else the library's own choice. A frame's time
// is two frames before its decoding.
//
// UNAVAILABLE, with what to do, when the camera is not there, cannot be opened, or gives no frame
// within settings.silence; so is a camera that was unplugged. It must not be opened twice at once.
// FAILED_PRECONDITION for intrinsics of another size.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenFreenect2(const std::string& serial,
                                                           const SensorSettings& settings);

// Serial numbers of the cameras that are connected now.
std::vector<std::string> ListFreenect2();

}  // namespace graspdb::client
