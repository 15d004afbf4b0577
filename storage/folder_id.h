// Whether a path still leads to the same folder.
#pragma once

#include <sys/stat.h>

#include <string>

namespace graspdb::storage {

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
