// Whole files, with the reason where they cannot be read. Internal to storage/.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace graspdb::storage {

// All bytes of a file. NOT_FOUND if there is none; UNAVAILABLE, with its path and the reason, if it
// cannot be read: that is no damage, and a backup does not help.
absl::StatusOr<std::string> ReadWholeFile(const std::string& path);

}  // namespace graspdb::storage
