// The points of a PCD file.
#pragma once

#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "files/points/pcd_header.h"
#include "files/points/point_file.h"

namespace graspdb::files {

// Ascii: all rows exist and have the number of finite or "nan" values that the header
// declares. Binary: the file is long enough. Compressed: both sizes at the start of
// the body agree with the header and the file.
//
// INVALID_ARGUMENT with the path, the error, its place and advice.
absl::Status CheckPcdBody(const std::filesystem::path& path, const PcdHeader& header);

// Decodes a file that passed ReadPcdHeader and CheckPcdBody; `sensor_pose` is left empty. PCL's
// reader is not used, as it parses the header again, interprets some lines differently and then
// crashes. INVALID_ARGUMENT when the compressed bytes cannot be unpacked. Takes a few times the
// memory of the file, or of its unpacked bytes.
absl::StatusOr<PointFile> DecodePcd(const std::filesystem::path& path, const PcdHeader& header);

// The bytes of a binary_compressed PCD file; `file` must be consistent, as WritePcd checks.
std::string EncodePcd(const PointFile& file);

}  // namespace graspdb::files
