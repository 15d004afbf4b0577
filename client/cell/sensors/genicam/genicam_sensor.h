// 3D cameras of GigE Vision and USB3 Vision with GenICam features, through Aravis.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

struct GenicamOptions {
  // PixelFormat to set, e.g. "Coord3D_ABC32f". Empty: the camera's, if it can be read, else the
  // first one that can.
  std::string pixel_format = {};
  // From the start of an exposure to the arrival of its image: exposure, computation in the camera
  // and transfer. Too small, a robot is given a frame from before its last motion.
  absl::Duration latency = absl::Milliseconds(500);
};

// Opens the camera `id`, as Aravis names it: the id that ListGenicam returns, a serial number's
// "Vendor-12345", or an IP address; "" for the first one. Enables its component Range, or else
// Disparity, alone, and starts the acquisition; the images are read as in range_image.h. Multipart
// buffers are read too.
//
// UNAVAILABLE when it is not connected or used by another program; FAILED_PRECONDITION for settings
// of the camera that cannot be used. Takes up to some seconds.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenGenicam(const std::string& id,
                                                         const GenicamOptions& options,
                                                         const SensorSettings& settings);

// The ids of the connected cameras, also those that are used, and those without depth. Takes up to
// some seconds.
absl::StatusOr<std::vector<std::string>> ListGenicam();

}  // namespace graspdb::client
