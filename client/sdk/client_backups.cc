// Backups.
#include <utility>

#include "base/status_macros.h"
#include "client/sdk/client_call.h"
#include "program/base/uuid.h"

namespace graspdb::client {

using BackupCalls = v1::BackupService::Stub;

absl::StatusOr<v1::Backup> Client::CreateBackup(const OnBytes& on_bytes) {
  v1::CreateBackupRequest request;
  request.set_request_id(MakeUuid4());
  grpc::ClientContext context;
  ASSIGN_OR_RETURN(auto last,
                   LastMessage<v1::CreateBackupResponse>(
                       context, stubs_->backups->CreateBackup(&context, request),
                       [&](const auto& message) { return on_bytes(message.done_byte_count()); }));
  return std::move(*last.mutable_backup());
}

absl::StatusOr<v1::Backup> Client::VerifyBackup(const std::string& name, const OnBytes& on_bytes) {
  v1::VerifyBackupRequest request;
  request.set_name(name);
  grpc::ClientContext context;
  ASSIGN_OR_RETURN(auto last,
                   LastMessage<v1::VerifyBackupResponse>(
                       context, stubs_->backups->VerifyBackup(&context, request),
                       [&](const auto& message) { return on_bytes(message.done_byte_count()); }));
  return std::move(*last.mutable_backup());
}

absl::StatusOr<v1::Backup> Client::CompareBackup(const std::string& name,
                                                 const OnDifferences& on_some) {
  v1::CompareBackupRequest request;
  request.set_name(name);
  grpc::ClientContext context;
  ASSIGN_OR_RETURN(auto last,
                   LastMessage<v1::CompareBackupResponse>(
                       context, stubs_->backups->CompareBackup(&context, request), on_some));
  return std::move(*last.mutable_backup());
}

absl::StatusOr<std::vector<v1::Backup>> Client::ListBackups() {
  return ListAll(*stubs_->backups, &BackupCalls::ListBackups, v1::ListBackupsRequest(),
                 &v1::ListBackupsResponse::mutable_backups);
}

absl::Status Client::DeleteBackup(const std::string& name) {
  return Call(*stubs_->backups, &BackupCalls::DeleteBackup, Named<v1::DeleteBackupRequest>(name))
      .status();
}

}  // namespace graspdb::client
