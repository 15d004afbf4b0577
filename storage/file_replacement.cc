#include "storage/file_replacement.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

namespace graspdb::storage {
namespace {

// A change of the catalogue may have to wait for the writes of a large file, so they are synced in
// portions.
constexpr std::size_t kSyncBytes = 8U << 20;

}  // namespace

FileReplacement::FileReplacement(std::string path)
    : path_(std::move(path)),
      next_(path_ + ".dbtmp"),
      file_(open(next_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)) {
  if (file_ < 0) status_ = DiskError();
}

FileReplacement::~FileReplacement() {
  if (file_ < 0) return;
  close(file_);
  unlink(next_.c_str());
}

absl::Status FileReplacement::Append(std::string_view bytes) {
  while (status_.ok() && !bytes.empty()) {
    const ssize_t written = write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return status_ = DiskError();
    bytes.remove_prefix(static_cast<std::size_t>(written));
    unsynced_ += static_cast<std::size_t>(written);
  }
  return unsynced_ < kSyncBytes ? status_ : WaitForDisk();
}

absl::Status FileReplacement::WaitForDisk() {
  unsynced_ = 0;
  if (status_.ok() && fsync(file_) != 0) status_ = DiskError();
  return status_;
}

absl::Status FileReplacement::Commit() {
  if (!WaitForDisk().ok()) return status_;
  if (rename(next_.c_str(), path_.c_str()) != 0) return status_ = DiskError();
  close(std::exchange(file_, -1));
  // The new name is durable once the directory is synced.
  const std::string directory = std::filesystem::path(path_).parent_path().string();
  const int names = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (names < 0) return status_ = DiskError();
  if (fsync(names) != 0) status_ = DiskError();
  close(names);
  return status_;
}

absl::Status FileReplacement::DiskError() {
  return absl::UnavailableError("cannot write " + path_ + " (" + std::strerror(errno) +
                                "); check the disk");
}

}  // namespace graspdb::storage
