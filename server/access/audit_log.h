// The file of --audit-log.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "graspdb/v1/audit.pb.h"
#include "server/access/file_state.h"

namespace graspdb::server {

// Records of calls as JSON, one a line. A full file FILE.log is renamed to FILE.1.log, that one to
// FILE.2.log, and so on; ten of them are kept. A full file that cannot be renamed goes on growing,
// which is logged. Each line is passed to the operating system at once: it survives the process,
// but not a power failure. A failing disk is logged and stops no call. Thread-safe.
class AuditLog {
 public:
  // Appends to the file; a new one can be read by its owner and group only. FAILED_PRECONDITION
  // when it cannot be opened.
  static absl::StatusOr<std::unique_ptr<AuditLog>> Open(const std::string& path,
                                                        std::uint64_t max_bytes);
  ~AuditLog();
  AuditLog(const AuditLog&) = delete;
  AuditLog& operator=(const AuditLog&) = delete;

  // Strings must be valid UTF-8.
  void Write(const v1::AuditRecord& record) ABSL_LOCKS_EXCLUDED(mutex_);

  // Why the last record is not in the file; absent if it is.
  std::optional<FileFault> fault() const { return state_.fault(); }
  // Records that could not be written.
  std::int64_t lost_count() const { return lost_count_; }

 private:
  AuditLog(const std::string& path, std::uint64_t max_bytes, int file)
      : path_(path), max_bytes_(max_bytes), file_(file), full_at_(max_bytes) {}

  // Logs and counts a record that is not in the file.
  void NoteLoss(const v1::AuditRecord& record, const std::string& reason);
  // 0 or an errno; then the current file is still the one that is open.
  int Rotate() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::filesystem::path path_;
  const std::uint64_t max_bytes_;
  FileState state_{"--audit-log"};
  std::atomic<std::int64_t> lost_count_ = 0;
  absl::Mutex mutex_;
  int file_ ABSL_GUARDED_BY(mutex_);
  std::uint64_t full_at_ ABSL_GUARDED_BY(mutex_);  // bytes; more than the maximum after a failure
};

}  // namespace graspdb::server
