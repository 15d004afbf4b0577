// Objects, stable poses, views and cells; their history, bulk uploads and backups.

#include <utility>

#include "base/status_macros.h"
#include "client/sdk/client_call.h"
#include "program/base/uuid.h"

namespace graspdb::client {
namespace {

using Uploads = v1::UploadService::Stub;

// Requests without a response. A view takes the server longer than its way there.
constexpr int kMaxPending = 8;

using History = v1::ObjectHistoryService::Stub;

using Catalog = v1::CatalogService::Stub;
using Cells = v1::CellService::Stub;

}  // namespace

absl::StatusOr<v1::CatalogStatus> Client::GetCatalogStatus() {
  return Call(*stubs_->catalog, &Catalog::GetCatalogStatus, v1::GetCatalogStatusRequest());
}

absl::StatusOr<v1::Object> Client::CreateObject(const v1::CreateObjectRequest& request) {
  return Call(*stubs_->catalog, &Catalog::CreateObject, request);
}

absl::StatusOr<v1::Object> Client::GetObject(const std::string& name) {
  return Call(*stubs_->catalog, &Catalog::GetObject, Named<v1::GetObjectRequest>(name));
}

absl::StatusOr<v1::Object> Client::UpdateObject(const v1::UpdateObjectRequest& request) {
  return Call(*stubs_->catalog, &Catalog::UpdateObject, request);
}

absl::Status Client::DeleteObject(const std::string& name, bool force) {
  v1::DeleteObjectRequest request;
  request.set_name(name);
  request.set_force(force);
  return Call(*stubs_->catalog, &Catalog::DeleteObject, request).status();
}

absl::StatusOr<v1::StablePose> Client::CreateStablePose(
    const v1::CreateStablePoseRequest& request) {
  return Call(*stubs_->catalog, &Catalog::CreateStablePose, request);
}

absl::StatusOr<v1::StablePose> Client::UpdateStablePose(
    const v1::UpdateStablePoseRequest& request) {
  return Call(*stubs_->catalog, &Catalog::UpdateStablePose, request);
}

absl::StatusOr<v1::ReportGraspOutcomeResponse> Client::ReportGraspOutcome(
    const v1::ReportGraspOutcomeRequest& request) {
  if (!request.request_id().empty()) {
    return Call(*stubs_->catalog, &Catalog::ReportGraspOutcome, request);
  }
  v1::ReportGraspOutcomeRequest once = request;
  once.set_request_id(MakeUuid4());
  return Call(*stubs_->catalog, &Catalog::ReportGraspOutcome, once);
}

absl::StatusOr<v1::StablePose> Client::GetStablePose(const std::string& name) {
  return Call(*stubs_->catalog, &Catalog::GetStablePose, Named<v1::GetStablePoseRequest>(name));
}

absl::StatusOr<v1::View> Client::GetView(const std::string& name) {
  v1::GetViewRequest request;
  request.set_name(name);
  request.set_detail(v1::VIEW_DETAIL_FULL);
  return Call(*stubs_->catalog, &Catalog::GetView, request);
}

absl::Status Client::DeleteView(const std::string& name) {
  return Call(*stubs_->catalog, &Catalog::DeleteView, Named<v1::DeleteViewRequest>(name)).status();
}

absl::StatusOr<std::vector<v1::Object>> Client::ListObjects() {
  return ListAll(*stubs_->catalog, &Catalog::ListObjects, v1::ListObjectsRequest(),
                 &v1::ListObjectsResponse::mutable_objects);
}

absl::StatusOr<std::vector<v1::StablePose>> Client::ListStablePoses(const std::string& object) {
  v1::ListStablePosesRequest request;
  request.set_parent(object);
  return ListAll(*stubs_->catalog, &Catalog::ListStablePoses, request,
                 &v1::ListStablePosesResponse::mutable_stable_poses);
}

absl::StatusOr<std::vector<v1::View>> Client::ListViews(const std::string& stable_pose) {
  v1::ListViewsRequest request;
  request.set_parent(stable_pose);
  request.set_page_size(1000);
  return ListAll(*stubs_->catalog, &Catalog::ListViews, request,
                 &v1::ListViewsResponse::mutable_views);
}

absl::StatusOr<v1::UploadViewsResponse> Client::UploadViews(const NextView& next) {
  grpc::ClientContext context;
  v1::UploadViewsResponse response;
  auto writer = stubs_->catalog->UploadViews(&context, &response);
  v1::UploadViewsRequest request;
  for (;;) {
    absl::StatusOr<bool> more = next(&request);
    if (!more.ok()) {
      context.TryCancel();
      (void)writer->Finish();  // cancelled here; the caller's error has the reason
      return more.status();
    }
    if (!*more || !writer->Write(request)) break;
  }
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  if (!status.ok()) return ToStatus(status, context);
  return response;
}

absl::StatusOr<v1::Cell> Client::CreateCell(const v1::CreateCellRequest& request) {
  return Call(*stubs_->cells, &Cells::CreateCell, request);
}

absl::StatusOr<v1::Cell> Client::GetCell(const std::string& name,
                                         std::optional<absl::Duration> timeout) {
  return Call(*stubs_->cells, &Cells::GetCell, Named<v1::GetCellRequest>(name),
              {.timeout = timeout.value_or(options_.timeout)});
}

absl::StatusOr<v1::Cell> Client::UpdateCell(const v1::UpdateCellRequest& request) {
  return Call(*stubs_->cells, &Cells::UpdateCell, request);
}

absl::Status Client::DeleteCell(const std::string& name) {
  return Call(*stubs_->cells, &Cells::DeleteCell, Named<v1::DeleteCellRequest>(name)).status();
}

absl::StatusOr<std::vector<v1::Cell>> Client::ListCells() {
  return ListAll(*stubs_->cells, &Cells::ListCells, v1::ListCellsRequest(),
                 &v1::ListCellsResponse::mutable_cells);
}

absl::StatusOr<std::vector<v1::Object>> Client::ListDeletedObjects() {
  return ListAll(*stubs_->history, &History::ListDeletedObjects, v1::ListDeletedObjectsRequest(),
                 &v1::ListDeletedObjectsResponse::mutable_objects);
}

absl::StatusOr<v1::Object> Client::GetDeletedObject(const std::string& name) {
  return Call(*stubs_->history, &History::GetDeletedObject,
              Named<v1::GetDeletedObjectRequest>(name));
}

absl::StatusOr<v1::Object> Client::UndeleteObject(const std::string& name) {
  return Call(*stubs_->history, &History::UndeleteObject, Named<v1::UndeleteObjectRequest>(name));
}

absl::Status Client::PurgeObject(const std::string& name) {
  return Call(*stubs_->history, &History::PurgeObject, Named<v1::PurgeObjectRequest>(name))
      .status();
}

absl::StatusOr<std::vector<v1::ObjectRevision>> Client::ListObjectRevisions(
    const std::string& object) {
  v1::ListObjectRevisionsRequest request;
  request.set_parent(object);
  return ListAll(*stubs_->history, &History::ListObjectRevisions, request,
                 &v1::ListObjectRevisionsResponse::mutable_revisions);
}

absl::StatusOr<v1::Object> Client::RestoreObject(const v1::RestoreObjectRequest& request) {
  return Call(*stubs_->history, &History::RestoreObject, request);
}

absl::StatusOr<v1::Upload> Client::CreateUpload(const v1::CreateUploadRequest& request) {
  return Call(*stubs_->uploads, &Uploads::CreateUpload, request);
}

absl::StatusOr<v1::Upload> Client::GetUpload(const std::string& name) {
  return Call(*stubs_->uploads, &Uploads::GetUpload, Named<v1::GetUploadRequest>(name));
}

absl::StatusOr<std::vector<v1::Upload>> Client::ListUploads() {
  return ListAll(*stubs_->uploads, &Uploads::ListUploads, v1::ListUploadsRequest(),
                 &v1::ListUploadsResponse::mutable_uploads);
}

absl::StatusOr<std::vector<v1::UploadView>> Client::ListUploadViews(const std::string& upload) {
  v1::ListUploadViewsRequest request;
  request.set_parent(upload);
  request.set_page_size(1000);
  return ListAll(*stubs_->uploads, &Uploads::ListUploadViews, request,
                 &v1::ListUploadViewsResponse::mutable_views);
}

absl::StatusOr<v1::Upload> Client::CommitUpload(const v1::CommitUploadRequest& request) {
  return Call(*stubs_->uploads, &Uploads::CommitUpload, request,
              {.timeout = absl::InfiniteDuration()});
}

absl::Status Client::DeleteUpload(const std::string& name) {
  return Call(*stubs_->uploads, &Uploads::DeleteUpload, Named<v1::DeleteUploadRequest>(name))
      .status();
}

absl::Status Client::WriteUploadViews(const NextUploadView& next, const UploadViewDone& done) {
  grpc::ClientContext context;
  const auto stream = stubs_->uploads->WriteUploadViews(&context);
  v1::WriteUploadViewsRequest request;
  v1::WriteUploadViewsResponse response;
  int pending = 0;
  bool more = true;
  bool broken = false;
  while (more || pending > 0) {
    if (more && pending < kMaxPending) {
      const absl::StatusOr<bool> filled = next(&request);
      if (!filled.ok()) {
        context.TryCancel();
        (void)stream->Finish();  // cancelled here; the caller's error has the reason
        return filled.status();
      }
      if (!*filled) stream->WritesDone();
      broken = *filled && !stream->Write(request);
      more = *filled && !broken;  // responses to earlier views are still read
      pending += *filled ? 1 : 0;
    } else {
      if (!stream->Read(&response)) {
        broken = true;
        break;
      }
      --pending;
      done(response);
    }
  }
  const grpc::Status status = stream->Finish();
  return status.ok() && broken
             ? absl::UnavailableError("the stream ended early; send the rest again")
             : ToStatus(status, context);
}

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
