// Whole files: reading them with the reason where it fails, and replacing them atomically. Internal
// to storage/.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace graspdb::storage {

// All bytes of a file. NOT_FOUND if there is none; UNAVAILABLE, with its path and the reason, if it
// cannot be read: that is no damage, and a backup does not help.
absl::StatusOr<std::string> ReadWholeFile(const std::string& path);

// Writes a temporary file beside `path` and renames it; returns when it is on the disk under its
// name. A crash at any time leaves the old file or the new one; the next replacement overwrites a
// leftover temporary file. One at a time per path. UNAVAILABLE when the disk fails; the old file
// stays then, unless only its folder could not be synced.
absl::Status ReplaceFile(const std::string& path, std::string_view bytes);

}  // namespace graspdb::storage
