#include "storage/folder_sync.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

namespace graspdb::storage {

std::error_code SyncFolder(const std::filesystem::path& folder, Unreadable unreadable) {
  const char* path = folder.empty() ? "." : folder.c_str();
  const int names = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (names < 0) {
    const bool is_accepted = errno == EACCES && unreadable == Unreadable::kIsAccepted;
    return {is_accepted ? 0 : errno, std::generic_category()};
  }
  const int error = fsync(names) == 0 ? 0 : errno;
  close(names);
  const bool is_unsupported = error == EINVAL || error == ENOTSUP || error == ENOSYS;
  return {is_unsupported ? 0 : error, std::generic_category()};
}

std::error_code MakeFolders(const std::filesystem::path& folder, Unreadable unreadable) {
  std::error_code error;
  std::vector<std::filesystem::path> missing;
  std::filesystem::path next = std::filesystem::absolute(folder, error);
  while (!error && !std::filesystem::exists(next, error)) {
    missing.push_back(next);
    next = next.parent_path();
  }
  if (!error) std::filesystem::create_directories(folder, error);
  for (const std::filesystem::path& made : missing) {
    if (!error) error = SyncFolder(made.parent_path(), unreadable);
  }
  for (const std::filesystem::path& made : missing) {
    if (error) rmdir(made.c_str());  // the next call would not flush those that stay
  }
  return error;
}

}  // namespace graspdb::storage
