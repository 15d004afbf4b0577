// What a directory holds, before a database is opened or made in it.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace graspdb::storage {

enum class DirectoryContent {
  kNothing,   // missing, empty, or left by a crash before a database was made
  kDatabase,  // a RocksDB database; whose, its records will say
};

// Looks at `directory` without changing it. FAILED_PRECONDITION when it is no
// directory or holds other people's files, DATA_LOSS when it holds what is left of a
// database of ours, UNAVAILABLE when it cannot be read.
absl::StatusOr<DirectoryContent> InspectDirectory(const std::string& directory);

// Makes `directory` with its parents. UNAVAILABLE when that fails.
absl::Status MakeDirectory(const std::string& directory);

}  // namespace graspdb::storage
