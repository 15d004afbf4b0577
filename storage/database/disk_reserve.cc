#include "storage/database/disk_reserve.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace graspdb::storage {
namespace {

// Of a small file system.
constexpr std::uint64_t kMinShare = 16;
constexpr std::uint64_t kBlockBytes = 512;  // of st_blocks

bool HasBlocks(const std::string& path, std::uint64_t bytes) {
  struct stat found {};
  return stat(path.c_str(), &found) == 0 && static_cast<std::uint64_t>(found.st_size) == bytes &&
         static_cast<std::uint64_t>(found.st_blocks) * kBlockBytes >= bytes;
}

bool IsFull(int error) { return error == ENOSPC || error == EDQUOT; }

// 0, or the system's error. Without space no file is left.
int Allocate(const std::string& path, std::uint64_t bytes) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return errno;
  const int error = fallocate(file, 0, 0, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
  close(file);
  if (error != 0) unlink(path.c_str());
  return error;
}

}  // namespace

DiskReserve::DiskReserve(const std::string& directory, std::uint64_t bytes)
    : directory_(directory), path_(directory + "/" + kReserveFile) {
  std::error_code error;
  const std::filesystem::space_info disk = std::filesystem::space(directory, error);
  if (!error) bytes_ = std::min<std::uint64_t>(bytes, disk.capacity / kMinShare);
}

void DiskReserve::Adopt() {
  absl::MutexLock lock(&mutex_);
  is_held_ = bytes_ > 0 && HasBlocks(path_, bytes_);
  if (!is_held_) unlink(path_.c_str());
}

bool DiskReserve::is_held() const {
  absl::MutexLock lock(&mutex_);
  return is_held_ || failure_ != 0 || bytes_ == 0;
}

int DiskReserve::failure() const {
  absl::MutexLock lock(&mutex_);
  return failure_;
}

void DiskReserve::Release() {
  absl::MutexLock lock(&mutex_);
  if (!is_held_) return;
  unlink(path_.c_str());
  is_held_ = false;
}

void DiskReserve::Take(std::uint64_t beside) {
  absl::MutexLock lock(&mutex_);
  if (is_held_ || bytes_ == 0 || failure_ == EOPNOTSUPP || failure_ == ENOSYS) return;
  std::error_code error;
  const std::filesystem::space_info disk = std::filesystem::space(directory_, error);
  if (error || disk.available < bytes_ + beside) return;
  const int failed = Allocate(path_, bytes_);
  is_held_ = failed == 0;
  failure_ = IsFull(failed) ? 0 : failed;
}

}  // namespace graspdb::storage
