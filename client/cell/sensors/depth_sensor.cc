#include "client/cell/sensors/depth_sensor.h"

#include <google/protobuf/timestamp.pb.h>

#include <cstdint>

#include "absl/time/clock.h"

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

}  // namespace graspdb::client
