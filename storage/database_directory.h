// Inspects a directory before a database is opened or created in it.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace graspdb::storage {

enum class DirectoryContent {
  kNothing,   // missing, empty, or left by a crash before a database was created
  kDatabase,  // a RocksDB database; its records identify the program
};

// Inspects `directory` without changing it. FAILED_PRECONDITION when it is not a
// directory or has files of other programs, DATA_LOSS when it has the remains of a
// graspdb database, UNAVAILABLE when it cannot be read.
absl::StatusOr<DirectoryContent> InspectDirectory(const std::string& directory);

// Deletes the index that earlier versions kept beside their database.
void DeleteOldIndex(const std::string& directory);

// Creates `directory` with its parents, durably. UNAVAILABLE on failure.
absl::Status MakeDirectory(const std::string& directory);

}  // namespace graspdb::storage
