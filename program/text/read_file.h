// Files of other programs, which may be of any size, or pipes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "absl/status/statusor.h"

namespace graspdb {

// The bytes of a file or pipe. Takes memory by what was read, not by the size that the file claims.
//
// NOT_FOUND where there is nothing at `path`, FAILED_PRECONDITION where it cannot be read,
// INVALID_ARGUMENT for more than `max_bytes`; each with the path and what to do.
absl::StatusOr<std::string> ReadFile(const std::filesystem::path& path, std::size_t max_bytes);

// The same of a text; see TakeUtf8().
absl::StatusOr<std::string> ReadTextFile(const std::filesystem::path& path, std::size_t max_bytes);

}  // namespace graspdb
