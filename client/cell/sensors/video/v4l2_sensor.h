// Depth cameras with a driver of Video4Linux and the pixel format Z16, such as RealSense.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/video/video_calls.h"

namespace graspdb::client {

// The size and the rows of an image; `bytes_per_row` may exceed the pixels.
struct Z16Layout {
  int width = 0;
  int height = 0;
  std::size_t bytes_per_row = 0;
};

// The counts, row by row. DATA_LOSS when `data` does not hold all rows; INVALID_ARGUMENT for a
// layout that is none. Allocates no more than `data` has.
absl::StatusOr<std::vector<std::uint16_t>> CountsOfZ16(std::span<const char> data,
                                                       const Z16Layout& layout);

// Metres a count of the model that the driver calls `card`, as it leaves the factory; nullopt for
// an unknown model. Z16 has no unit of its own.
std::optional<double> DepthUnitOfModel(const std::string& card);

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
