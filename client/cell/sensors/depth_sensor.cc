#include "client/cell/sensors/depth_sensor.h"

#include <google/protobuf/timestamp.pb.h>

#include <cstdint>

namespace graspdb::client {

void SetTime(absl::Time time, SensorFrame& frame) {
  frame.time = time;
  const std::int64_t seconds = absl::ToUnixSeconds(time);  // rounded down
  const absl::Duration rest = time - absl::FromUnixSeconds(seconds);
  google::protobuf::Timestamp stamp;
  stamp.set_seconds(seconds);
  stamp.set_nanos(static_cast<std::int32_t>(absl::ToInt64Nanoseconds(rest)));
  std::visit([&stamp](auto& scan) { *scan.mutable_capture_time() = stamp; }, frame.scan);
}

}  // namespace graspdb::client
