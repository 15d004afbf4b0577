// Bundle files, which are four bytes, "GBB" and the version 1, then the message Bundle; and a
// folder of them with a size limit.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graspdb/v1/bundle.pb.h"

namespace graspdb::client {

// The bytes of the file. RESOURCE_EXHAUSTED for a bundle over the message limit (2 GB).
absl::StatusOr<std::string> BundleBytes(const v1::Bundle& bundle);

// NOT_FOUND when the file does not exist, DATA_LOSS when it is not a bundle, truncated or over 2
// GB, FAILED_PRECONDITION when it cannot be read or its version is newer.
absl::StatusOr<v1::Bundle> ReadBundle(const std::filesystem::path& path);

// Expands files and folders: a folder to the bundles in it, the oldest first. NOT_FOUND for a
// missing path and for a folder without bundles.
absl::StatusOr<std::vector<std::filesystem::path>> ListBundles(
    const std::vector<std::string>& paths);

// A lock on a folder, until it is destroyed or the process dies. Movable.
class FolderLock {
 public:
  // FAILED_PRECONDITION while another FolderLock has the folder, in this process or another one,
  // and when the folder cannot be opened. On file systems without locks nothing is locked.
  static absl::StatusOr<FolderLock> Take(const std::filesystem::path& folder);

  FolderLock(FolderLock&& other) noexcept : folder_(std::exchange(other.folder_, -1)) {}
  FolderLock& operator=(FolderLock&& other) noexcept {
    std::swap(folder_, other.folder_);
    return *this;
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  explicit FolderLock(int folder) : folder_(folder) {}

  int folder_ = -1;  // its descriptor; -1 after a move
};

struct BundleRingOptions {
  std::filesystem::path folder;
  // Maximum total size of the bundles.
  std::uint64_t byte_limit = 2ULL << 30;
  // Minimum free disk space; the oldest bundles are removed first, then new ones are rejected.
  std::uint64_t min_free_bytes = 1ULL << 30;
};

// The folder belongs to one ring at a time, of all processes: two would overwrite each other's
// bundles. Files are named
// "NNNNNNNNNN-YYYYMMDDTHHMMSSZ.bundle" by an increasing number, so that the order does not depend
// on the clock. Writes are atomic, even if the process is killed; Open removes temporary files of
// interrupted writes. Other files are ignored and not counted. Not thread-safe.
class BundleRing {
 public:
  // Creates the folder if missing, and takes over existing bundles: those beyond the limit are
  // removed, the oldest first. PERMISSION_DENIED or FAILED_PRECONDITION when it cannot be used, or
  // is in use.
  static absl::StatusOr<BundleRing> Open(BundleRingOptions options);

  // Writes a bundle's bytes, after removing the oldest bundles as needed. RESOURCE_EXHAUSTED when
  // it is larger than the limit or the disk is too full; PERMISSION_DENIED, FAILED_PRECONDITION.
  absl::Status Add(const std::string& bytes, absl::Time time);

 private:
  struct File {
    std::filesystem::path path;
    std::uint64_t bytes = 0;
  };

  explicit BundleRing(BundleRingOptions options) : options_(std::move(options)) {}
  absl::Status TakeOver();
  absl::Status RemoveOldest();
  absl::Status MakeSpace(std::uint64_t bytes);
  bool IsDiskFull(std::uint64_t bytes) const;

  BundleRingOptions options_;
  std::optional<FolderLock> lock_;
  std::deque<File> files_;  // the oldest in front
  std::uint64_t bytes_ = 0;
  std::uint64_t next_ = 1;
};

}  // namespace graspdb::client
