// Checks the body of a PCD file against its header.
#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "files/points/pcd_header.h"

namespace graspdb::files {

// Ascii: all rows exist and have the number of finite or "nan" values that the header
// declares. Binary: the file is long enough. Compressed: both sizes at the start of
// the body agree with the header and the file.
//
// INVALID_ARGUMENT with the path, the error, its place and advice.
absl::Status CheckPcdBody(const std::filesystem::path& path, const PcdHeader& header);

}  // namespace graspdb::files
