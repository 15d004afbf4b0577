#include "client/cell/sensors/fresh_sensor.h"

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"

namespace graspdb::client {

absl::StatusOr<SensorFrame> FreshSensor::Next(absl::Time deadline) {
  absl::StatusOr<SensorFrame> frame = sensor_->Next(deadline);
  if (!frame.ok()) return frame;
  const absl::Duration age = absl::Now() - frame->time;
  if (age > max_age_) {
    return absl::UnavailableError(absl::StrCat(
        "the newest frame is ", absl::FormatDuration(age), " old and the limit is ",
        absl::FormatDuration(max_age_), "; is the camera or this machine overloaded?"));
  }
  if (age < -max_age_) {
    return absl::UnavailableError(absl::StrCat("the newest frame is from ",
                                               absl::FormatDuration(-age),
                                               " ahead; has the clock of this machine been set?"));
  }
  return frame;
}

}  // namespace graspdb::client
