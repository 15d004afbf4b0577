// Atomic replacement of a file. Internal to storage/.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::storage {

// Writes a temporary file beside `path` and renames it. A crash at any time leaves the old file or
// the new one; the next replacement overwrites a leftover temporary file. One at a time per path;
// not thread-safe.
class FileReplacement {
 public:
  explicit FileReplacement(std::string path);
  // Discards uncommitted bytes.
  ~FileReplacement();
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  // UNAVAILABLE when the disk fails; the old file stays then, and further appends fail.
  absl::Status Append(std::string_view bytes);
  // Returns when the new file is on the disk under its name. Errors as Append().
  absl::Status Commit();

 private:
  absl::Status WaitForDisk();
  absl::Status DiskError();

  const std::string path_;
  const std::string next_;
  int file_;
  std::size_t unsynced_ = 0;  // bytes
  absl::Status status_;
};

}  // namespace graspdb::storage
