// Objects, stable poses, views and cells.

#include "client/sdk/client_call.h"
#include "program/base/uuid.h"

namespace graspdb::client {
namespace {

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

}  // namespace graspdb::client
