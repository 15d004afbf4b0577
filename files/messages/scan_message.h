// Scans in messages: depth images or clouds.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/catalog.pb.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"

namespace graspdb::files {

using ScanMessage = std::variant<v1::DepthImage, v1::PointCloud>;

// Makes it the scan of `message`, a RecognizeRequest or a View without a scan.
template <typename Message>
void SetScan(ScanMessage scan, Message* message) {
  if (auto* image = std::get_if<v1::DepthImage>(&scan)) {
    *message->mutable_depth_image() = std::move(*image);
  } else {
    *message->mutable_cloud() = std::move(std::get<v1::PointCloud>(scan));
  }
}

// Points as packed x, y, z floats. `width`: columns of the image, row by row; 0 if not an image.
v1::PointCloud CloudMessage(const recognition::Points& points, int width);

// The points of a cloud from a server (x, y, z floats). INVALID_ARGUMENT for another
// layout.
absl::StatusOr<recognition::Points> PointsFromMessage(const v1::PointCloud& cloud);

// An id computed from the view's points or depth image: the same capture gives the same id.
std::string ContentId(const v1::View& view);

// The count of cameras that do not write 0 where nothing was measured: saturated.
inline constexpr std::uint16_t kNoCount = 65535;

// `counts` (row by row, 0 or kNoCount without measurement) of `unit_m` metres along the sensor's z
// axis, as the camera sends them; camera.width * camera.height counts are required.
v1::DepthImage DepthMessage(const std::vector<std::uint16_t>& counts,
                            const recognition::CameraIntrinsics& camera, double unit_m);

// Depths in metres, row by row, in the finest unit with which 16 bits reach `far_m`: rounding moves
// a depth by at most 8 um per metre of `far_m`. Farther depths, 0 and NaN are no measurement.
v1::DepthImage FineDepthMessage(std::span<const float> depths_m,
                                const recognition::CameraIntrinsics& camera, double far_m);

// The counts of an image, row by row. INVALID_ARGUMENT when there are not width * height.
absl::StatusOr<std::vector<std::uint16_t>> CountsFromMessage(const v1::DepthImage& image);

// The points of an image, sensor frame, metres, row by row; NaN: not measured. INVALID_ARGUMENT as
// CountsFromMessage, and for focal lengths that are not positive.
absl::StatusOr<recognition::Points> PointsFromMessage(const v1::DepthImage& image);

// Metres per count.
double DepthUnit(const v1::DepthImage& image);

v1::CameraIntrinsics ToMessage(const recognition::CameraIntrinsics& camera);
recognition::CameraIntrinsics FromMessage(const v1::CameraIntrinsics& message);

}  // namespace graspdb::files
