#include "server/access/audit_log.h"

#include <google/protobuf/util/json_util.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "program/log_field.h"

namespace graspdb::server {
namespace {

// Full files beside the current one; doubled, twice as much history.
constexpr std::size_t kFullFiles = 10;

}  // namespace

absl::StatusOr<std::unique_ptr<AuditLog>> AuditLog::Open(const std::string& path,
                                                         std::size_t max_bytes) {
  try {
    auto sink = std::make_shared<spdlog::sinks::rotating_file_sink_mt>(path, max_bytes, kFullFiles);
    auto file = std::make_shared<spdlog::logger>("audit", std::move(sink));
    file->set_pattern("%v");
    file->set_level(spdlog::level::info);
    file->flush_on(spdlog::level::info);
    file->set_error_handler([](const std::string& error) {
      spdlog::error("event=audit_not_written error={}", LogField(error));
    });
    return std::unique_ptr<AuditLog>(new AuditLog(std::move(file)));
  } catch (const spdlog::spdlog_ex& error) {
    return absl::FailedPreconditionError(absl::StrCat("cannot write --audit-log: ", error.what()));
  }
}

void AuditLog::Write(const v1::AuditRecord& record) {
  std::string line;
  if (!google::protobuf::util::MessageToJsonString(record, &line).ok()) {
    spdlog::error("event=audit_not_written method={}", LogField(record.method()));
    return;
  }
  file_->info("{}", line);
}

}  // namespace graspdb::server
