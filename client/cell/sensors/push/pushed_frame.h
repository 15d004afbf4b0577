// Frames that another program sends, which are untrusted.
#pragma once

#include <cstddef>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "graspdb/v1/frame_service.pb.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

// Bytes of a camera's name.
inline constexpr std::size_t kMaxCameraNameBytes = 256;
// Age of a frame; an older one shows clocks that differ, or another unit.
inline constexpr absl::Duration kMaxPushedAge = absl::Minutes(1);

// The frame of a request, which came at `arrival` by the wall clock and `now` by the monotonic one.
// Clouds are repacked as x, y, z floats, as the rest of the agent reads them; takes no more memory
// than the request. INVALID_ARGUMENT with the field: no name, no scan, wrong sizes, strides,
// fields, intrinsics or depth unit, a time that is missing, in the future or older than
// kMaxPushedAge, coordinates that can only be millimetres. A frame without a measurement is valid.
// Thread-safe.
absl::StatusOr<SensorFrame> PushedFrame(const v1::PushFrameRequest& request, absl::Time arrival,
                                        MonotonicTime now);

}  // namespace graspdb::client
