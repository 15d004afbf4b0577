#include "storage/base/folder_sync.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

namespace graspdb::storage {
namespace {

// Flushes the name of a folder that exists: its maker may have been killed before. Whoever made it
// in a folder that cannot be read could not do more.
std::error_code SyncNameOf(const std::filesystem::path& folder) {
  std::error_code error;
  // Without links, "." and a slash at the end, so that the folder above has the name.
  const std::filesystem::path real = std::filesystem::canonical(folder, error);
  if (error) return error;
  if (!std::filesystem::is_directory(real, error)) {
    return error ? error : std::make_error_code(std::errc::not_a_directory);
  }
  const std::error_code synced = SyncFolder(real.parent_path(), Unreadable::kIsAccepted);
  // A file system that is mounted in one that is read-only: the name cannot have been made lately.
  return synced == std::errc::read_only_file_system ? std::error_code() : synced;
}

}  // namespace

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
  std::filesystem::path found = std::filesystem::absolute(folder, error);
  while (!error && !std::filesystem::exists(found, error)) {
    missing.push_back(found);
    found = found.parent_path();
  }
  if (!error) error = SyncNameOf(found);
  // Each is flushed before the next is made: of those that exist after a kill only the lowest may
  // not be, and that is the one that the next call flushes.
  std::vector<std::filesystem::path> made;
  for (auto next = missing.rbegin(); !error && next != missing.rend(); ++next) {
    if (std::filesystem::create_directory(*next, error)) made.push_back(*next);
    if (!error) error = SyncFolder(next->parent_path(), unreadable);
  }
  // The next call would accept a folder above that cannot be read.
  for (auto last = made.rbegin(); error && last != made.rend(); ++last) rmdir(last->c_str());
  return error;
}

}  // namespace graspdb::storage
