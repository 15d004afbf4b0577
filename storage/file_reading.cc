#include "storage/file_reading.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "absl/status/status.h"

namespace graspdb::storage {
namespace {

// 0 or an errno.
int ReadToEnd(int file, std::string* bytes) {
  struct stat state {};
  if (fstat(file, &state) != 0) return errno;
  bytes->resize(static_cast<std::size_t>(state.st_size));
  std::size_t done = 0;
  while (done < bytes->size()) {
    const ssize_t count = read(file, bytes->data() + done, bytes->size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes->resize(done);
  return 0;
}

absl::Status CannotReadFile(const std::string& path, int error) {
  const std::string reason = std::generic_category().message(error);
  // Also below a file in place of the folder.
  if (error == ENOENT || error == ENOTDIR) {
    return absl::NotFoundError("there is no file " + path + " (" + reason + ")");
  }
  return absl::UnavailableError("the file " + path + " cannot be read (" + reason +
                                "); check its permissions, those of its folder, and the disk");
}

}  // namespace

absl::StatusOr<std::string> ReadWholeFile(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return CannotReadFile(path, errno);
  std::string bytes;
  const int error = ReadToEnd(file, &bytes);
  close(file);
  if (error != 0) return CannotReadFile(path, error);
  return bytes;
}

}  // namespace graspdb::storage
