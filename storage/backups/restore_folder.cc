#include "storage/backups/restore_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <system_error>

#include "base/status_macros.h"
#include "storage/base/folder_sync.h"

namespace graspdb::storage {
namespace {

constexpr std::string_view kPrefix = ".graspdb-restoring-";

absl::Status CannotRestore(const std::filesystem::path& database, const std::string& reason) {
  return absl::UnavailableError("cannot restore to " + database.string() + " (" + reason +
                                "); check the disk and the permissions of its parent");
}

absl::Status CheckEmpty(const std::filesystem::path& database) {
  std::error_code error;
  const auto type = std::filesystem::status(database, error).type();
  if (type == std::filesystem::file_type::not_found) return absl::OkStatus();
  if (!error && type != std::filesystem::file_type::directory) {
    return absl::FailedPreconditionError(database.string() +
                                         " is not a folder; restore to a new folder");
  }
  const bool is_empty = !error && std::filesystem::is_empty(database, error);
  if (error) return CannotRestore(database, error.message());
  if (is_empty) return absl::OkStatus();
  return absl::FailedPreconditionError(database.string() +
                                       " is not empty; restore to a new folder, or move the old "
                                       "database away first");
}

}  // namespace

absl::StatusOr<std::unique_ptr<RestoreFolder>> RestoreFolder::Make(const std::string& database) {
  std::error_code error;
  std::filesystem::path target =
      std::filesystem::weakly_canonical(std::filesystem::absolute(database, error), error);
  if (!error && !target.has_filename()) target = target.parent_path();  // "db/"
  if (!error) error = MakeFolders(target.parent_path());
  if (error) return CannotRestore(database, error.message());
  RETURN_IF_ERROR(CheckEmpty(target));

  const std::filesystem::path path =
      target.parent_path() / (std::string(kPrefix) + target.filename().string());
  std::unique_ptr<RestoreFolder> folder(new RestoreFolder(target, path));
  RETURN_IF_ERROR(folder->Lock());
  for (std::filesystem::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    std::filesystem::remove_all(entry->path(), error);
  }
  if (error) return CannotRestore(target, error.message());
  return folder;
}

absl::Status RestoreFolder::Lock() {
  std::error_code error;
  std::filesystem::create_directory(path_, error);
  if (error) return CannotRestore(database_, error.message());
  // Through a link the files of another folder would be deleted.
  const int folder = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) return CannotRestore(database_, std::strerror(errno));
  // Another restore may have published this folder since it was opened: then it is its database.
  struct stat opened {};
  struct stat named {};
  const bool is_locked = flock(folder, LOCK_EX | LOCK_NB) == 0 && fstat(folder, &opened) == 0 &&
                         lstat(path_.c_str(), &named) == 0 && opened.st_ino == named.st_ino;
  if (is_locked) {
    folder_ = folder;
    return absl::OkStatus();
  }
  close(folder);
  return absl::FailedPreconditionError("another restore to " + database_.string() +
                                       " is running; wait for its end");
}

RestoreFolder::~RestoreFolder() {
  if (folder_ < 0) return;
  std::error_code error;
  std::filesystem::remove_all(path_, error);  // the next restore empties it otherwise
  close(folder_);
}

absl::Status RestoreFolder::Publish() {
  if (const auto error = SyncFolder(path_)) return CannotRestore(path_, error.message());
  if (std::rename(path_.c_str(), database_.c_str()) != 0) {
    return CannotRestore(database_, std::strerror(errno));
  }
  close(std::exchange(folder_, -1));
  const std::error_code error = SyncFolder(database_.parent_path());
  return error ? CannotRestore(database_, error.message()) : absl::OkStatus();
}

}  // namespace graspdb::storage
