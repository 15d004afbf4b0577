// Whether the body of a PCD file keeps what the header promises.
#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "files/pcd_header.h"

namespace graspdb::client {

// Ascii: every row is there with as many finite or "nan" numbers as the header
// says. Binary: the file is long enough. Compressed: both sizes at the start of
// the body agree with the header and the file.
//
// INVALID_ARGUMENT with the path, what is wrong and where, and what to do.
absl::Status CheckPcdBody(const std::filesystem::path& path, const PcdHeader& header);

}  // namespace graspdb::client
