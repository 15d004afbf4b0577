#include "server/access/audit_log.h"

#include <fcntl.h>
#include <google/protobuf/util/json_util.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string_view>
#include <system_error>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "program/log/log_field.h"

namespace graspdb::server {
namespace {

// Full files beside the current one.
constexpr int kFullFiles = 10;

// FILE.2.log of FILE.log; 0 is the file itself.
std::filesystem::path NumberedFile(const std::filesystem::path& path, int number) {
  if (number == 0) return path;
  return path.parent_path() /
         absl::StrCat(path.stem().string(), ".", number, path.extension().string());
}

int OpenToAppend(const std::filesystem::path& path) {
  return open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0640);
}

// 0 for a pipe or a device, which is never full.
std::uint64_t BytesOfFile(int file) {
  const off_t end = lseek(file, 0, SEEK_END);
  return end < 0 ? 0 : static_cast<std::uint64_t>(end);
}

// 0 or an errno.
int AppendAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace

absl::StatusOr<std::unique_ptr<AuditLog>> AuditLog::Open(const std::string& path,
                                                         std::uint64_t max_bytes) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code ignored;  // without the folder the file cannot be opened
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
  const int file = OpenToAppend(path);
  if (file >= 0) return std::unique_ptr<AuditLog>(new AuditLog(path, max_bytes, file));
  return absl::FailedPreconditionError(
      absl::StrCat("cannot write --audit-log ", path, " (", std::generic_category().message(errno),
                   "); choose a folder in which the server may write"));
}

AuditLog::~AuditLog() { close(file_); }

// The names move up to the first free one, so that repeated failures do not lose old files.
int AuditLog::Rotate() {
  int number = 1;
  while (number < kFullFiles && access(NumberedFile(path_, number).c_str(), F_OK) == 0) ++number;
  for (; number > 0; --number) {
    const std::filesystem::path from = NumberedFile(path_, number - 1);
    if (std::rename(from.c_str(), NumberedFile(path_, number).c_str()) != 0 && errno != ENOENT) {
      return errno;
    }
  }
  const int next = OpenToAppend(path_);
  if (next < 0) {
    const int error = errno;
    std::rename(NumberedFile(path_, 1).c_str(), path_.c_str());
    return error;
  }
  close(std::exchange(file_, next));
  return 0;
}

void AuditLog::NoteLoss(const v1::AuditRecord& record, const std::string& reason) {
  ++lost_count_;
  state_.Note(absl::UnavailableError(
      absl::StrCat("cannot write --audit-log ", path_.string(), " (", reason, ")")));
  spdlog::error("event=audit_not_written method={} error={}", LogField(record.method()),
                LogField(reason));
}

void AuditLog::Write(const v1::AuditRecord& record) {
  std::string line;
  if (!google::protobuf::util::MessageToJsonString(record, &line).ok()) {
    NoteLoss(record, "the record is not text");
    return;
  }
  line += '\n';
  const absl::MutexLock lock(&mutex_);
  std::uint64_t bytes = BytesOfFile(file_);
  if (bytes > 0 && bytes + line.size() > full_at_) {
    const int error = Rotate();
    full_at_ = error == 0 ? max_bytes_ : bytes + max_bytes_;
    if (error != 0) {
      spdlog::error("event=audit_not_rotated error={}",
                    LogField(std::generic_category().message(error)));
    }
    bytes = BytesOfFile(file_);
  }
  const int error = AppendAll(file_, line);
  if (error == 0) {
    state_.Note(absl::OkStatus());
    return;
  }
  // The next line must not continue a half of this one.
  const bool is_cut = ftruncate(file_, static_cast<off_t>(bytes)) == 0;
  NoteLoss(record, absl::StrCat(std::generic_category().message(error),
                                is_cut ? "" : ", and a part of its line stays"));
}

}  // namespace graspdb::server
