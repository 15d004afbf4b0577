#include "client/cell/blackbox/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace graspdb::client {

absl::StatusOr<FolderLock> FolderLock::Take(const std::filesystem::path& folder) {
  const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("cannot use ", folder.string(), ": ", std::generic_category().message(errno),
                     "; choose another folder or make this one readable"));
  }
  FolderLock out(opened);
  // Any other error means that the file system has no locks.
  if (flock(opened, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return absl::FailedPreconditionError(absl::StrCat(
        folder.string(), " is in use by another process; give each one a folder of its own"));
  }
  return out;
}

FolderLock::~FolderLock() {
  if (folder_ >= 0) close(folder_);
}

}  // namespace graspdb::client
