// Depth cameras with a driver of Video4Linux and the pixel format Z16, such as RealSense.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/sensor_settings.h"
#include "client/cell/sensors/video/video_calls.h"

namespace graspdb::client {

struct V4l2Options {
  // Metres a count; absent: that of the model, see DepthUnitOfModel.
  std::optional<double> unit_m = {};
  // From the start of an exposure to the kernel's timestamp. uvcvideo takes it when the first
  // packet of an image arrives, although it calls that the start of the exposure.
  absl::Duration latency = kExposureToArrival;
};

// Opens the device `path`, such as /dev/video2, in the image size of settings.intrinsics, which are
// required: Video4Linux has none. UNAVAILABLE when it is not connected or used by another program;
// FAILED_PRECONDITION when it has no Z16, not that size, or an unknown unit, and without
// intrinsics.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenV4l2(const std::string& path,
                                                      const V4l2Options& options,
                                                      const SensorSettings& settings);

// The same with an opened device.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenV4l2(const std::string& path,
                                                      std::unique_ptr<VideoCalls> video,
                                                      const V4l2Options& options,
                                                      const SensorSettings& settings);

// The paths of the devices with Z16. NOT_FOUND, with what there is instead, when there are none.
absl::StatusOr<std::vector<std::string>> ListV4l2();

}  // namespace graspdb::client
