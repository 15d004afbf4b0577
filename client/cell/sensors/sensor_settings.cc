#include "client/cell/sensors/sensor_settings.h"

#include "absl/strings/str_cat.h"

namespace graspdb::client {

absl::Status CheckIntrinsics(const SensorSettings& settings, const std::string& camera, int width,
                             int height) {
  const auto& given = settings.intrinsics;
  if (!given || (given->width == width && given->height == height)) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(camera, " has ", width, " x ", height,
                                                    " pixels and its intrinsics ", given->width,
                                                    " x ", given->height, "; correct them"));
}

}  // namespace graspdb::client
