// A folder of bundles with a size limit.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/blackbox/folder_lock.h"

namespace graspdb::client {

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
