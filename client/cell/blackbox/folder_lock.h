// Lets one process at a time use a folder.
#pragma once

#include <filesystem>
#include <utility>

#include "absl/status/statusor.h"

namespace graspdb::client {

// A lock on a folder, until it is destroyed or the process dies. Movable.
class FolderLock {
 public:
  // FAILED_PRECONDITION while another FolderLock has the folder, in this process or another one,
  // and when the folder cannot be opened. On file systems without locks nothing is locked.
  static absl::StatusOr<FolderLock> Take(const std::filesystem::path& folder);

  FolderLock(FolderLock&& other) noexcept : folder_(std::exchange(other.folder_, -1)) {}
  FolderLock& operator=(FolderLock&& other) noexcept {
    std::swap(folder_, other.folder_);
    return *this;
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  explicit FolderLock(int folder) : folder_(folder) {}

  int folder_ = -1;  // its descriptor; -1 after a move
};

}  // namespace graspdb::client
