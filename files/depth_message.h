// Conversion of depth images to protobuf messages.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// `counts` (row by row, 0 without measurement) of `unit_m` metres along the sensor's z axis, as the
// camera sends them; camera.width * camera.height counts are required.
v1::DepthImage DepthMessage(const std::vector<std::uint16_t>& counts,
                            const recognition::CameraIntrinsics& camera, double unit_m);

// The counts of an image, row by row. INVALID_ARGUMENT when there are not width * height.
absl::StatusOr<std::vector<std::uint16_t>> CountsFromMessage(const v1::DepthImage& image);

// Metres per count.
double DepthUnit(const v1::DepthImage& image);

v1::CameraIntrinsics ToMessage(const recognition::CameraIntrinsics& camera);
recognition::CameraIntrinsics FromMessage(const v1::CameraIntrinsics& message);

}  // namespace graspdb::client
