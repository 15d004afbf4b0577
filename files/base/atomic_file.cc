#include "files/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "storage/base/folder_sync.h"

namespace graspdb::files {
namespace {

absl::Status StatusOf(int error, const std::string& text) {
  if (error == EACCES || error == EPERM || error == EROFS) {
    return absl::PermissionDeniedError(text);
  }
  if (error == ENOSPC || error == EDQUOT) return absl::ResourceExhaustedError(text);
  return absl::FailedPreconditionError(text);
}

absl::Status Failed(const std::filesystem::path& path, int error) {
  return StatusOf(error, absl::StrCat("cannot write ", path.string(), ": ",
                                      std::generic_category().message(error),
                                      "; choose another folder or make this one writable"));
}

absl::Status FolderFailed(const std::filesystem::path& folder, const char* what,
                          const std::error_code& error) {
  return StatusOf(
      error.value(),
      absl::StrCat("cannot ", what, " the folder ", folder.string(), ": ", error.message(),
                   "; choose another folder, or check its permissions and the disk"));
}

absl::Status NotDurable(const std::filesystem::path& path, int error) {
  return StatusOf(error, absl::StrCat(path.string(),
                                      " is written, but its folder cannot be flushed to the disk: ",
                                      std::generic_category().message(error), "; check the disk"));
}

// 0 or an errno.
int WriteAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return 0;
}

// As rename(2), but EEXIST where there is a file at `to`. 0 or an errno.
int RenameNew(const char* from, const char* to) {
  if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // Network file systems do not know the flag; most have links.
  if (link(from, to) == 0) {
    unlink(from);
    return 0;
  }
  struct stat found {};
  if (errno == EEXIST || lstat(to, &found) == 0) return EEXIST;
  return rename(from, to) == 0 ? 0 : errno;
}

std::error_code MakeFolderOf(const std::filesystem::path& path, Durability durability) {
  std::error_code error;
  if (!path.has_parent_path()) return error;
  if (durability == Durability::kPowerFailure) {
    return storage::MakeFolders(path.parent_path(), storage::Unreadable::kIsAccepted);
  }
  std::filesystem::create_directories(path.parent_path(), error);
  return error;
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path path, Durability durability, std::string temporary,
                       int file)
    : path_(std::move(path)),
      durability_(durability),
      temporary_(std::move(temporary)),
      file_(file) {}

AtomicFile::~AtomicFile() {
  if (file_ >= 0) close(file_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

absl::StatusOr<std::unique_ptr<AtomicFile>> AtomicFile::Create(const std::filesystem::path& path,
                                                               Durability durability) {
  if (const auto error = MakeFolderOf(path, durability)) return Failed(path, error.value());
  const std::string temporary = absl::StrCat(path.string(), ".", getpid(), ".tmp");
  const int file =
      open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (file < 0) return Failed(path, errno);
  return std::unique_ptr<AtomicFile>(new AtomicFile(path, durability, temporary, file));
}

absl::Status AtomicFile::Append(std::string_view bytes) {
  const int error = WriteAll(file_, bytes);
  return error == 0 ? absl::OkStatus() : Failed(path_, error);
}

absl::Status AtomicFile::Commit(Existing existing) {
  int error = 0;
  if (durability_ != Durability::kProcessCrash && fsync(file_) != 0) error = errno;
  if (close(std::exchange(file_, -1)) != 0 && error == 0) error = errno;
  if (error == 0 && existing == Existing::kKeep) {
    error = RenameNew(temporary_.c_str(), path_.c_str());
    if (error == EEXIST) {
      return absl::AlreadyExistsError(absl::StrCat(path_.string(), " exists; choose another file"));
    }
  } else if (error == 0 && rename(temporary_.c_str(), path_.c_str()) != 0) {
    error = errno;
  }
  if (error != 0) return Failed(path_, error);
  temporary_.clear();
  if (durability_ != Durability::kPowerFailure) return absl::OkStatus();
  const std::error_code unflushed =
      storage::SyncFolder(path_.parent_path(), storage::Unreadable::kIsAccepted);
  return unflushed ? NotDurable(path_, unflushed.value()) : absl::OkStatus();
}

absl::Status WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes,
                                 Durability durability) {
  ASSIGN_OR_RETURN(const std::unique_ptr<AtomicFile> file, AtomicFile::Create(path, durability));
  RETURN_IF_ERROR(file->Append(bytes));
  return file->Commit();
}

absl::Status MakeDurableFolder(const std::filesystem::path& folder) {
  const std::error_code error = storage::MakeFolders(folder, storage::Unreadable::kIsAccepted);
  return error ? FolderFailed(folder, "make", error) : absl::OkStatus();
}

absl::Status FlushNames(const std::filesystem::path& folder) {
  const std::error_code error = storage::SyncFolder(folder, storage::Unreadable::kIsAccepted);
  return error ? FolderFailed(folder, "flush", error) : absl::OkStatus();
}

}  // namespace graspdb::files
