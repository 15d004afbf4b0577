// Files that are there whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::client {

// Writes `bytes` beside `path`, flushes them to the disk and renames the result
// to `path`, replacing what was there; folders on the way are made. A reader
// sees the old file or the new one, never a part, also after a crash. Two
// writers of one path must not run at the same time.
//
// PERMISSION_DENIED, RESOURCE_EXHAUSTED (disk full) or UNAVAILABLE (any other
// failure), with the path; what was at `path` is then untouched.
absl::Status WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace graspdb::client
