// Atomic replacement of a file. Internal to storage/.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::storage {

// Writes a temporary file beside `path` and renames it; returns when it is on the disk under its
// name. A crash at any time leaves the old file or the new one; the next replacement overwrites a
// leftover temporary file. One at a time per path. UNAVAILABLE when the disk fails; the old file
// stays then, unless only its folder could not be synced.
absl::Status ReplaceFile(const std::string& path, std::string_view bytes);

}  // namespace graspdb::storage
