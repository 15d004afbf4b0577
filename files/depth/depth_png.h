// Depth images in 16-bit PNG files; depth_png.cc is the only file that depends on libpng.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "files/depth/lens.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"

namespace graspdb::files {

// The sidecar file with the camera of the images in a folder, as JSON:
//   {"width": 640, "height": 480, "fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5,
//    "depthUnitM": 0.001}
// Pixels; metres per count. depthUnitM is optional, by default millimetres. Files of other programs
// are read too: their units (DepthUnitOf), invalid counts, distortion (LensOf), camera matrices.
// Keys that mean none of these are ignored.
inline constexpr char kIntrinsicsFile[] = "intrinsics.json";

struct DepthPngCamera {
  recognition::CameraIntrinsics intrinsics;
  double depth_unit_m = 0.001;
  std::vector<std::uint16_t> invalid_counts = {};  // besides 0 and 65535
  Lens lens = {};
};

// Reads a sidecar. NOT_FOUND when there is none, FAILED_PRECONDITION when it cannot be read;
// INVALID_ARGUMENT with the path and the key when it is larger than 64 KiB, not JSON, a key is
// missing or not a number, a size, focal length or unit is not positive, the principal point is
// outside of the image, or a key may change the meaning of the image and is not known.
absl::StatusOr<DepthPngCamera> ReadIntrinsics(const std::filesystem::path& path);

// Writes a sidecar atomically, without invalid counts and lens. Errors as WriteFileAtomically.
absl::Status WriteIntrinsics(const std::filesystem::path& path, const DepthPngCamera& camera);

// Reads a PNG file with one channel of 16 bits; 0 without measurement, also where the file has
// 65535 or an invalid count of the camera. The lens is not undone. Safe on any bytes. Thread-safe.
// NOT_FOUND when there is no such file, FAILED_PRECONDITION when it cannot be read;
// INVALID_ARGUMENT with the path when it is larger than 256 MiB, not a PNG,
// damaged, of another kind (e.g. an 8-bit picture of the depth), not of the size of `camera`, or
// when the bytes of its counts are swapped.
absl::StatusOr<v1::DepthImage> ReadDepthPng(const std::filesystem::path& path,
                                            const DepthPngCamera& camera);

// Writes the counts of `image` atomically; unit and intrinsics go into a sidecar, see
// WriteIntrinsics. The same image gives the same bytes. INVALID_ARGUMENT when the size of the data
// does not match the intrinsics; otherwise the errors of WriteFileAtomically.
absl::Status WriteDepthPng(const std::filesystem::path& path, const v1::DepthImage& image);

}  // namespace graspdb::files
