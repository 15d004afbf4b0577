#include "storage/folder_sync.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

namespace graspdb::storage {

std::error_code SyncFolder(const std::filesystem::path& folder) {
  const char* path = folder.empty() ? "." : folder.c_str();
  const int names = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  int error = names >= 0 && fsync(names) == 0 ? 0 : errno;
  if (names >= 0) close(names);
  const bool is_unsupported = error == EINVAL || error == ENOTSUP || error == ENOSYS;
  if (names >= 0 && is_unsupported) error = 0;
  return {error, std::generic_category()};
}

std::error_code MakeFolders(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> parents;  // of the missing ones
  std::filesystem::path next = std::filesystem::absolute(folder, error);
  while (!error && !std::filesystem::exists(next, error)) {
    next = next.parent_path();
    parents.push_back(next);
  }
  if (!error) std::filesystem::create_directories(folder, error);
  for (const std::filesystem::path& parent : parents) {
    if (!error) error = SyncFolder(parent);
  }
  return error;
}

}  // namespace graspdb::storage
