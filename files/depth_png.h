// Depth images in 16-bit PNG files; the one place where libpng is known.
#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// The file beside the images of a folder that says what camera took them, as flat JSON:
//   {"width": 640, "height": 480, "fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5,
//    "depthUnitM": 0.001}
// Pixels; metres a count. depthUnitM may be left out: millimetres. Other keys are passed over.
inline constexpr char kIntrinsicsFile[] = "intrinsics.json";

struct DepthPngCamera {
  recognition::CameraIntrinsics intrinsics;
  double depth_unit_m = 0.001;
};

// Reads a sidecar. NOT_FOUND when there is none; INVALID_ARGUMENT with the path and the key when it
// is no JSON, a key is missing or no number, or a size, focal length or unit is not positive.
absl::StatusOr<DepthPngCamera> ReadIntrinsics(const std::filesystem::path& path);

// Writes a sidecar, whole or not at all. Errors as WriteFileAtomically.
absl::Status WriteIntrinsics(const std::filesystem::path& path, const DepthPngCamera& camera);

// Reads a PNG file with one channel of 16 bits, 0 without measurement. Safe on any bytes.
// Thread-safe. NOT_FOUND when there is no such file; INVALID_ARGUMENT with the path when it is no
// PNG, damaged, of another kind (as an 8-bit picture of the depth is), or not of the size that
// `camera` says.
absl::StatusOr<v1::DepthImage> ReadDepthPng(const std::filesystem::path& path,
                                            const DepthPngCamera& camera);

// Writes the counts of `image`, whole or not at all; unit and intrinsics go into a sidecar, see
// WriteIntrinsics. The same image gives the same bytes. INVALID_ARGUMENT when the image has not the
// size that it says; otherwise the errors of WriteFileAtomically.
absl::Status WriteDepthPng(const std::filesystem::path& path, const v1::DepthImage& image);

}  // namespace graspdb::client
