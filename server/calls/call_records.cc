// What is recorded about calls: in the log, the audit log and the metrics.
#include <google/protobuf/util/time_util.h>
#include <spdlog/spdlog.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/time/clock.h"
#include "program/log/log_field.h"
#include "server/access/method_role.h"
#include "server/base/errors.h"
#include "server/calls/call_guard.h"
#include "server/requests/request_limits.h"

namespace graspdb::server {
namespace {

// TimeUtil::GetCurrentTime() has whole seconds, too few to order calls or to find them in the log.
google::protobuf::Timestamp AuditTime() {
  return google::protobuf::util::TimeUtil::MillisecondsToTimestamp(absl::ToUnixMillis(absl::Now()));
}

}  // namespace

void RecordRefusedHandshake(const AccessRules& rules, const absl::Status& refused) {
  const std::string error = BoundedText(std::string(refused.message()), 2 * kMaxStringBytes);
  spdlog::warn("event=handshake_refused error={}", LogField(error));
  if (rules.audit == nullptr) return;
  v1::AuditRecord record;
  *record.mutable_time() = AuditTime();
  record.set_method("TLS handshake");
  record.set_catalog_revision(rules.revision());
  record.set_code(absl::StatusCodeToString(refused.code()));
  record.set_error(error);
  rules.audit->Write(record);
}

void CallGuard::Record(std::string_view method, const grpc::Status& status,
                       absl::Duration time) const {
  if (metrics() != nullptr) metrics()->CountCall(method, status, time);
  Audit(status);
}

void CallGuard::Audit(const grpc::Status& status) const {
  const bool is_refused = status.error_code() == grpc::StatusCode::PERMISSION_DENIED ||
                          status.error_code() == grpc::StatusCode::UNAUTHENTICATED;
  if (method_ != nullptr && (is_refused || IsAudited(*method_))) WriteAuditRecord(status);
}

void CallGuard::WriteAuditRecord(const grpc::Status& status) const {
  if (rules_.audit == nullptr) return;
  v1::AuditRecord record;
  *record.mutable_time() = AuditTime();
  record.set_identity(identity_);
  record.set_peer(context_.peer());
  record.set_method(method_->full_name());
  for (const std::string& resource : resources_) record.add_resources(resource);
  record.set_catalog_revision(rules_.revision());
  record.set_code(absl::StatusCodeToString(static_cast<absl::StatusCode>(status.error_code())));
  record.set_error(status.error_message());
  record.set_request_id(request_id_);
  rules_.audit->Write(record);
}

void CallGuard::RecordWithoutPlace(std::string_view method, const grpc::Status& status) {
  if (metrics() != nullptr) metrics()->CountCall(method, status, absl::ZeroDuration());
  const std::optional<std::int64_t> count = rules_.places->CountRefusal();
  if (!count) return;
  spdlog::warn("event=calls_refused count={} method={} identity={} peer={} error={}", *count,
               method, LogField(identity_), LogField(context_.peer()),
               LogField(status.error_message()));
  WriteAuditRecord(status);
}

}  // namespace graspdb::server
