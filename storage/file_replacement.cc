#include "storage/file_replacement.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace graspdb::storage {
namespace {

// A change of the catalogue may have to wait for the writes of a large file, so they are synced in
// portions.
constexpr std::size_t kSyncBytes = 8U << 20;

// An open file or directory.
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

// The names in a directory are durable once it is synced.
bool SyncNames(const std::string& directory) {
  const OpenFile names(directory, O_RDONLY | O_DIRECTORY);
  return names.number() >= 0 && fsync(names.number()) == 0;
}

}  // namespace

absl::Status ReplaceFile(const std::string& path, std::string_view bytes) {
  const std::string next = path + ".dbtmp";
  if (WriteDurably(next, bytes) && rename(next.c_str(), path.c_str()) == 0 &&
      SyncNames(std::filesystem::path(path).parent_path().string())) {
    return absl::OkStatus();
  }
  absl::Status failed = absl::UnavailableError("cannot write " + path + " (" +
                                               std::strerror(errno) + "); check the disk");
  unlink(next.c_str());
  return failed;
}

}  // namespace graspdb::storage
