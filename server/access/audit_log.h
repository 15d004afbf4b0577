// The file of --audit-log.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "graspdb/v1/audit.pb.h"

namespace spdlog {
class logger;
}

namespace graspdb::server {

// Records of calls as JSON, one a line. A full file FILE.log is renamed to FILE.1.log, that one to
// FILE.2.log, and so on; ten of them are kept. Each line is passed to the operating system at once:
// it survives the process, but not a power failure. A failing disk is logged and stops no call.
// Thread-safe.
class AuditLog {
 public:
  // Appends to the file. FAILED_PRECONDITION when it cannot be opened.
  static absl::StatusOr<std::unique_ptr<AuditLog>> Open(const std::string& path,
                                                        std::size_t max_bytes);

  // Strings must be valid UTF-8.
  void Write(const v1::AuditRecord& record);

 private:
  explicit AuditLog(std::shared_ptr<spdlog::logger> file) : file_(std::move(file)) {}

  std::shared_ptr<spdlog::logger> file_;
};

}  // namespace graspdb::server
