#include "files/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace graspdb::client {
namespace {

absl::Status Failed(const std::filesystem::path& path, int error) {
  const std::string text =
      absl::StrCat("cannot write ", path.string(), ": ", std::generic_category().message(error),
                   "; choose another folder or make this one writable");
  if (error == EACCES || error == EPERM || error == EROFS) {
    return absl::PermissionDeniedError(text);
  }
  if (error == ENOSPC || error == EDQUOT) return absl::ResourceExhaustedError(text);
  return absl::FailedPreconditionError(text);
}

// 0 or an errno.
int WriteAll(int file, std::string_view bytes, Durability durability) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  if (durability == Durability::kProcessCrash) return 0;
  return fsync(file) == 0 ? 0 : errno;
}

// 0 or an errno. Creates the file `path` with the content `bytes`.
int WriteNew(const std::string& path, std::string_view bytes, Durability durability) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return errno;
  const int error = WriteAll(file, bytes, durability);
  const int close_error = close(file) == 0 ? 0 : errno;
  return error != 0 ? error : close_error;
}

}  // namespace

absl::Status WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes,
                                 Durability durability) {
  std::error_code made;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), made);
  if (made) return Failed(path, made.value());
  const std::string temporary = absl::StrCat(path.string(), ".", getpid(), ".tmp");
  int error = WriteNew(temporary, bytes, durability);
  if (error == 0 && rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0) return absl::OkStatus();
  unlink(temporary.c_str());
  return Failed(path, error);
}

}  // namespace graspdb::client
