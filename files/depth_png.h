// Depth images in 16-bit PNG files; depth_png.cc is the only file that depends on libpng.
#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// The sidecar file with the camera of the images in a folder, as flat JSON:
//   {"width": 640, "height": 480, "fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5,
//    "depthUnitM": 0.001}
// Pixels; metres per count. depthUnitM is optional, by default millimetres. Other keys are ignored.
inline constexpr char kIntrinsicsFile[] = "intrinsics.json";

struct DepthPngCamera {
  recognition::CameraIntrinsics intrinsics;
  double depth_unit_m = 0.001;
};

// Reads a sidecar. NOT_FOUND when there is none; INVALID_ARGUMENT with the path and the key when it
// is not JSON, a key is missing or not a number, or a size, focal length or unit is not positive.
absl::StatusOr<DepthPngCamera> ReadIntrinsics(const std::filesystem::path& path);

// Writes a sidecar atomically. Errors as WriteFileAtomically.
absl::Status WriteIntrinsics(const std::filesystem::path& path, const DepthPngCamera& camera);

// Reads a PNG file with one channel of 16 bits, 0 without measurement. Safe on any bytes.
// Thread-safe. NOT_FOUND when there is no such file; INVALID_ARGUMENT with the path when it is not
// a PNG, damaged, of another kind (e.g. an 8-bit picture of the depth), or not of the size of
// `camera`.
absl::StatusOr<v1::DepthImage> ReadDepthPng(const std::filesystem::path& path,
                                            const DepthPngCamera& camera);

// Writes the counts of `image` atomically; unit and intrinsics go into a sidecar, see
// WriteIntrinsics. The same image gives the same bytes. INVALID_ARGUMENT when the size of the data
// does not match the intrinsics; otherwise the errors of WriteFileAtomically.
absl::Status WriteDepthPng(const std::filesystem::path& path, const v1::DepthImage& image);

}  // namespace graspdb::client
