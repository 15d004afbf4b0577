// A folder of bundles that never grows beyond a size.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace graspdb::client {

struct BundleRingOptions {
  std::filesystem::path folder;
  // All bundles together are never larger.
  std::uint64_t byte_limit = 2ULL << 30;
  // So much is left free on the disk for others; the oldest bundles go first, then nothing is kept.
  std::uint64_t least_free_bytes = 1ULL << 30;
};

// The folder belongs to one ring of one process at a time. Files are named
// "NNNNNNNNNN-YYYYMMDDTHHMMSSZ.bundle" by a number that only grows, so that a clock that was set
// back changes no order. Each is there whole or not at all, whenever the process ends; what an end
// in the middle of a write left behind is removed at opening. Other files are left alone and not
// counted. Not thread-safe.
class BundleRing {
 public:
  // Makes the folder where it is missing, and takes over what is in it: a smaller limit than the
  // last time removes the oldest. PERMISSION_DENIED or FAILED_PRECONDITION when it cannot be used.
  static absl::StatusOr<BundleRing> Open(BundleRingOptions options);

  // Writes a bundle's bytes, and removes as many of the oldest as that takes. RESOURCE_EXHAUSTED
  // when it is larger than the limit or the disk is too full; PERMISSION_DENIED,
  // FAILED_PRECONDITION.
  absl::Status Add(const std::string& bytes, absl::Time time);

  // Of the bundles that are there: for tests, the ring itself sees to its limits.
  std::size_t size() const { return files_.size(); }
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct File {
    std::filesystem::path path;
    std::uint64_t bytes = 0;
  };

  explicit BundleRing(BundleRingOptions options) : options_(std::move(options)) {}
  absl::Status TakeOver();
  absl::Status RemoveOldest();
  absl::Status MakeRoom(std::uint64_t bytes);
  bool IsDiskFull(std::uint64_t bytes) const;

  BundleRingOptions options_;
  std::deque<File> files_;  // the oldest in front
  std::uint64_t bytes_ = 0;
  std::uint64_t next_ = 1;
};

}  // namespace graspdb::client
