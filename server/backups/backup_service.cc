#include "server/backups/backup_service.h"

#include <atomic>
#include <chrono>
#include <future>

#include "base/status_macros.h"
#include "server/backups/backup_messages.h"
#include "server/base/background.h"
#include "server/calls/call_guard.h"
#include "server/calls/handle.h"
#include "server/requests/record_checks.h"
#include "server/requests/respond.h"

namespace graspdb::server {
namespace {

// Interval of progress messages, and the time in which a cancelled call is noticed.
constexpr std::chrono::milliseconds kReportInterval{100};

// Differences in a message: at most 128 KiB, as names have at most 256 bytes or so.
constexpr int kBatch = 500;

// Runs `work` on a thread of low priority, and writes its progress until it has ended; a client
// that does not read delays only its own messages.
template <typename Response, typename Work>
absl::Status RunReported(const grpc::ServerContext& context, grpc::ServerWriter<Response>* stream,
                         const Work& work) {
  std::atomic<std::int64_t> bytes = 0;
  std::atomic<bool> is_cancelled = false;
  storage::BackupProgress progress;
  progress.on_bytes = [&bytes](std::int64_t done) { bytes = done; };
  progress.is_cancelled = [&is_cancelled] { return is_cancelled.load(); };
  auto result = std::async(std::launch::async, [&] {
    LowerPriority();
    return work(progress);
  });
  Response response;
  while (result.wait_for(kReportInterval) != std::future_status::ready) {
    response.set_done_byte_count(bytes);
    if (IsAbandoned(context) || !stream->Write(response)) is_cancelled = true;
  }
  ASSIGN_OR_RETURN(const storage::Backup backup, result.get());
  response.set_done_byte_count(bytes);
  *response.mutable_backup() = BackupToProto(backup);
  // No request has the name of a new one.
  if (CallGuard* guard = CallGuard::Of(context)) guard->NoteResource(response.backup().name());
  return stream->Write(response) ? absl::OkStatus()
                                 : absl::CancelledError("the stream was cancelled");
}

}  // namespace

absl::Status BackupService::CheckEnabled() const {
  if (backups_ != nullptr) return absl::OkStatus();
  return absl::FailedPreconditionError(
      "this server has no folder for backups; start it with --backup-dir FOLDER");
}

grpc::Status BackupService::CreateBackup(grpc::ServerContext* context,
                                         const v1::CreateBackupRequest* request,
                                         grpc::ServerWriter<v1::CreateBackupResponse>* stream) {
  return Handle(*context, "CreateBackup", *request, [&]() -> absl::Status {
    RETURN_IF_ERROR(CheckEnabled());
    ASSIGN_OR_RETURN(const auto id, WriteIdFromProto(request->request_id()));
    return RunReported(*context, stream,
                       [&](const auto& progress) { return backups_->Create(progress, id); });
  });
}

grpc::Status BackupService::ListBackups(grpc::ServerContext* context,
                                        const v1::ListBackupsRequest* request,
                                        v1::ListBackupsResponse* response) {
  return Handle(*context, "ListBackups", *request, [&]() -> absl::Status {
    RETURN_IF_ERROR(CheckEnabled());
    ASSIGN_OR_RETURN(const auto size, PageSize(request->page_size()));
    ASSIGN_OR_RETURN(const auto after, NameFromPageToken(request->page_token(), "backups/"));
    storage::BackupId after_id = 0;
    if (!after.empty()) {
      ASSIGN_OR_RETURN(after_id, ParseBackupName(after, "page_token"));
    }
    ASSIGN_OR_RETURN(const auto backups, backups_->List());
    for (const storage::Backup& backup : backups) {
      if (backup.id <= after_id) continue;
      if (static_cast<std::size_t>(response->backups_size()) == size) {
        response->set_next_page_token(PageTokenAfter(response->backups().rbegin()->name()));
        break;
      }
      *response->add_backups() = BackupToProto(backup);
    }
    return absl::OkStatus();
  });
}

grpc::Status BackupService::VerifyBackup(grpc::ServerContext* context,
                                         const v1::VerifyBackupRequest* request,
                                         grpc::ServerWriter<v1::VerifyBackupResponse>* stream) {
  return Handle(*context, "VerifyBackup", *request, [&]() -> absl::Status {
    RETURN_IF_ERROR(CheckEnabled());
    ASSIGN_OR_RETURN(const auto id, ParseBackupName(request->name(), "name"));
    return RunReported(*context, stream,
                       [&](const auto& progress) { return backups_->Verify(id, progress); });
  });
}

grpc::Status BackupService::DeleteBackup(grpc::ServerContext* context,
                                         const v1::DeleteBackupRequest* request,
                                         google::protobuf::Empty* /*response*/) {
  return Handle(*context, "DeleteBackup", *request, [&]() -> absl::Status {
    RETURN_IF_ERROR(CheckEnabled());
    ASSIGN_OR_RETURN(const auto id, ParseBackupName(request->name(), "name"));
    return backups_->Delete(id);
  });
}

grpc::Status BackupService::CompareBackup(grpc::ServerContext* context,
                                          const v1::CompareBackupRequest* request,
                                          grpc::ServerWriter<v1::CompareBackupResponse>* stream) {
  return Handle(*context, "CompareBackup", *request, [&]() -> absl::Status {
    RETURN_IF_ERROR(CheckEnabled());
    ASSIGN_OR_RETURN(const auto id, ParseBackupName(request->name(), "name"));
    return InBackground([&]() -> absl::Status {
      absl::Status cancelled = absl::CancelledError("the stream was cancelled");
      AbandonedWatch watch(*context);
      storage::BackupProgress progress;
      progress.is_cancelled = [&watch] { return watch.IsAbandoned(); };
      v1::CompareBackupResponse response;
      const auto send = [&](const storage::Difference& difference) -> absl::Status {
        *response.add_differences() = DifferenceToProto(difference);
        if (response.differences_size() < kBatch) return absl::OkStatus();
        if (!stream->Write(response)) return cancelled;
        response.clear_differences();
        return absl::OkStatus();
      };
      ASSIGN_OR_RETURN(const auto backup, backups_->Compare(id, progress, send));
      *response.mutable_backup() = BackupToProto(backup);
      return stream->Write(response) ? absl::OkStatus() : cancelled;
    });
  });
}

}  // namespace graspdb::server
