#include "client/cell/sensors/depth_sensor.h"

#include <google/protobuf/timestamp.pb.h>

#include <cstdint>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"

namespace graspdb::client {

void SetTime(MonotonicTime time, SensorFrame& frame) {
  frame.time = time;
  const absl::Duration age = MonotonicTime::Now() - time;
  const absl::Time wall = absl::Now() - age;
  const std::int64_t seconds = absl::ToUnixSeconds(wall);  // rounded down
  const absl::Duration rest = wall - absl::FromUnixSeconds(seconds);
  google::protobuf::Timestamp stamp;
  stamp.set_seconds(seconds);
  stamp.set_nanos(static_cast<std::int32_t>(absl::ToInt64Nanoseconds(rest)));
  std::visit([&stamp](auto& scan) { *scan.mutable_capture_time() = stamp; }, frame.scan);
}

absl::StatusOr<SensorFrame> FreshSensor::Next(MonotonicTime deadline) {
  ASSIGN_OR_RETURN(SensorFrame frame, sensor_->Next(deadline));
  const absl::Duration age = MonotonicTime::Now() - frame.time;
  if (age > max_age_) {
    return absl::UnavailableError(absl::StrCat(
        "the newest frame is ", absl::FormatDuration(age), " old and the limit is ",
        absl::FormatDuration(max_age_), "; is the camera or this machine overloaded?"));
  }
  return frame;
}

absl::Status CheckIntrinsics(const SensorSettings& settings, const std::string& camera, int width,
                             int height) {
  const auto& given = settings.intrinsics;
  if (!given || (given->width == width && given->height == height)) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(camera, " has ", width, " x ", height,
                                                    " pixels and its intrinsics ", given->width,
                                                    " x ", given->height, "; correct them"));
}

}  // namespace graspdb::client
