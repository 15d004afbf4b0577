// Atomic writes of files.
#pragma once

#include <filesystem>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::client {

// Whether a file must survive a power failure right after it was written. Waiting
// for the disk takes milliseconds, on a busy one far longer.
enum class Durability { kProcessCrash, kPowerFailure };

// Writes `bytes` beside `path` and renames the result to `path`, replacing an
// existing file; missing folders are created. A reader sees the old file or the new
// one, never a part; with kPowerFailure also after the machine stopped. Two
// writers of one path must not run at the same time.
//
// PERMISSION_DENIED, RESOURCE_EXHAUSTED (disk full) or FAILED_PRECONDITION (any
// other failure), with the path; a file at `path` is then unchanged.
absl::Status WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes,
                                 Durability durability);

}  // namespace graspdb::client
