// Whether a file of the server's settings can be used.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"

namespace graspdb::server {

// Why a file cannot be used.
struct FileFault {
  std::string flag;  // that names the file
  std::string error;
  absl::Time begin;
};

// The result of the last use of a file. Thread-safe.
class FileState {
 public:
  // `flag` is the one that names the file.
  explicit FileState(std::string flag) : flag_(std::move(flag)) {}

  // The file was used, with this result.
  void Note(const absl::Status& status) ABSL_LOCKS_EXCLUDED(mutex_);

  // The error of the last use, since the first one that failed; absent if it succeeded.
  std::optional<FileFault> fault() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  const std::string flag_;
  mutable absl::Mutex mutex_;
  std::optional<FileFault> fault_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::server
