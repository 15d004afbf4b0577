// The directory of a database: what is in it before it is opened or created, and whether it is
// still the same one.
#pragma once

#include <sys/stat.h>

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

// Equal for a folder as long as no other one, or file system, is in its place.
struct FolderId {
  dev_t device = 0;
  ino_t number = 0;
  bool operator==(const FolderId&) const = default;
};

// Zeros where there is none.
inline FolderId FolderIdOf(const std::string& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0) return {};
  return {found.st_dev, found.st_ino};
}

}  // namespace graspdb::storage
