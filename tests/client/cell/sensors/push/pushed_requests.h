// Requests of programs that push frames.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/time/time.h"
#include "files/messages/scan_message.h"
#include "graspdb/v1/frame_service.pb.h"

namespace graspdb::client {

inline google::protobuf::Timestamp Stamp(absl::Time time) {
  google::protobuf::Timestamp out;
  const std::int64_t nanos = absl::ToUnixNanos(time);
  out.set_seconds(nanos / 1'000'000'000);
  out.set_nanos(static_cast<std::int32_t>(nanos % 1'000'000'000));
  return out;
}

// A depth image of 4 x 3 pixels at `depth_mm`, captured at `time`.
inline v1::PushFrameRequest ImageRequest(absl::Time time, std::uint16_t depth_mm = 800) {
  v1::PushFrameRequest out;
  out.set_camera("left");
  *out.mutable_depth_image() =
      files::DepthMessage(std::vector<std::uint16_t>(12, depth_mm),
                          {.width = 4, .height = 3, .fx = 5, .fy = 6, .cx = 1.5, .cy = 1}, 0.001);
  *out.mutable_depth_image()->mutable_capture_time() = Stamp(time);
  return out;
}

// Two rows of two points, one of them not measured, captured at `time`.
inline v1::PushFrameRequest CloudRequest(absl::Time time) {
  v1::PushFrameRequest out;
  out.set_camera("left");
  *out.mutable_cloud() =
      files::CloudMessage(recognition::Points{{0, 0, 1}, {0, 0, 0}, {0.5F, 0, 1}, {0, 0.5F, 1}}, 2);
  *out.mutable_cloud()->mutable_capture_time() = Stamp(time);
  return out;
}

}  // namespace graspdb::client
