// The second Kinect (Kinect for Xbox One, for Windows v2) through libfreenect2. Built only if that
// library is installed, which is not in Debian 12: see docs/sensors.md.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

inline constexpr int kKinectV2Width = 512;
inline constexpr int kKinectV2Height = 424;

// Opens the camera with the serial number `serial` (empty: the first) and waits for its first
// frame. Frames are undistorted depth images, 512 x 424, in 0.1 mm, with the camera's own
// intrinsics unless the settings have some, 30 a second. The decoder is $LIBFREENECT2_PIPELINE
// (cpu, gl, cl, cuda), by default the library's choice. A frame's time is two frames before its
// decoding.
//
// UNAVAILABLE, with the next step, when the camera is not connected, cannot be opened, or gives no
// frame within settings.silence; also after it was unplugged. It must not be opened twice at once.
// FAILED_PRECONDITION for intrinsics of another size.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenFreenect2(const std::string& serial,
                                                           const SensorSettings& settings);

// Serial numbers of the connected cameras.
std::vector<std::string> ListFreenect2();

}  // namespace graspdb::client
