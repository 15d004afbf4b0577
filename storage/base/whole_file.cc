#include "storage/base/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "storage/base/folder_sync.h"

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

// A change of the catalogue may have to wait for the writes of a large file, so they are synced in
// portions.
constexpr std::size_t kSyncBytes = 8U << 20;

// An open file.
class OpenFile {
 public:
  OpenFile(const std::string& path, int flags)
      : number_(open(path.c_str(), flags | O_CLOEXEC, 0644)) {}
  ~OpenFile() {
    if (number_ >= 0) close(number_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int number() const { return number_; }

 private:
  const int number_;
};

// Whether `bytes` are on the disk; else errno has the reason.
bool WriteDurably(const std::string& path, std::string_view bytes) {
  const OpenFile file(path, O_WRONLY | O_CREAT | O_TRUNC);
  if (file.number() < 0) return false;
  while (!bytes.empty()) {
    const ssize_t written = write(file.number(), bytes.data(), std::min(bytes.size(), kSyncBytes));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 || fsync(file.number()) != 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

absl::StatusOr<std::string> ReadWholeFile(const std::string& path) {
  const OpenFile file(path, O_RDONLY);
  std::string bytes;
  const int error = file.number() < 0 ? errno : ReadToEnd(file.number(), &bytes);
  if (error != 0) return CannotReadFile(path, error);
  return bytes;
}

absl::Status ReplaceFile(const std::string& path, std::string_view bytes) {
  const std::string next = path + ".dbtmp";
  std::error_code error;
  if (WriteDurably(next, bytes) && rename(next.c_str(), path.c_str()) == 0) {
    error = SyncFolder(std::filesystem::path(path).parent_path());
  } else {
    error.assign(errno, std::generic_category());
  }
  if (!error) return absl::OkStatus();
  unlink(next.c_str());
  return absl::UnavailableError("cannot write " + path + " (" + error.message() +
                                "); check the disk");
}

}  // namespace graspdb::storage
