// A file that is replaced as a whole or not at all. Internal to storage/.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::storage {

// Writes beside `path` and puts the result in its place. A crash at any moment leaves the old
// file or the new one; the bytes beside it, if any are left, are overwritten by the next
// replacement. One at a time for a path; not thread-safe.
class FileReplacement {
 public:
  explicit FileReplacement(std::string path);
  // Drops what was not committed.
  ~FileReplacement();
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  // UNAVAILABLE when the disk fails; the old file stays then, whatever is appended after it.
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
