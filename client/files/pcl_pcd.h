// PCL's PCD reader and writer; the one place where PCL's types are known.
#pragma once

#include <filesystem>
#include <string>

#include "absl/status/statusor.h"
#include "client/files/pcd_header.h"
#include "client/files/point_file.h"

namespace graspdb::client {

// Decodes a file whose header and body were checked (ReadPcdHeader,
// CheckPcdBody). `sensor_pose` is left empty. INVALID_ARGUMENT when the
// compressed bytes cannot be unpacked. Silences PCL's console for the process.
absl::StatusOr<PointFile> DecodePcd(const std::filesystem::path& path, const PcdHeader& header);

// The bytes of a binary_compressed PCD file; `file` must be consistent, as
// WritePcd checks. INTERNAL when PCL refuses it.
absl::StatusOr<std::string> EncodePcd(const PointFile& file);

}  // namespace graspdb::client
