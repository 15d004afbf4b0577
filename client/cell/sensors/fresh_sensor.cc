#include "client/cell/sensors/fresh_sensor.h"

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::client {

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

}  // namespace graspdb::client
