// Objects, stable poses, views and cells.
#include <utility>

#include "client/sdk/client_call.h"

namespace graspdb::client {
namespace {

using Catalog = v1::CatalogService::Stub;
using Cells = v1::CellService::Stub;

// Lists all pages: `list(token)` returns one, `take(page)` stores its records.
template <typename List, typename Take>
absl::Status ForEachPage(List&& list, Take&& take) {
  std::string token;
  do {
    auto page = list(token);
    if (!page.ok()) return page.status();
    token = page->next_page_token();
    take(*std::move(page));
  } while (!token.empty());
  return absl::OkStatus();
}

template <typename Record, typename Field>
void Append(Field& field, std::vector<Record>* out) {
  for (auto& record : field) out->push_back(std::move(record));
}

}  // namespace

absl::StatusOr<v1::CatalogStatus> Client::GetCatalogStatus() {
  return Call<v1::CatalogStatus>(*stubs_->catalog, &Catalog::GetCatalogStatus,
                                 v1::GetCatalogStatusRequest());
}

absl::StatusOr<v1::Object> Client::CreateObject(const v1::CreateObjectRequest& request) {
  return Call<v1::Object>(*stubs_->catalog, &Catalog::CreateObject, request);
}

absl::StatusOr<v1::Object> Client::GetObject(const std::string& name) {
  v1::GetObjectRequest request;
  request.set_name(name);
  return Call<v1::Object>(*stubs_->catalog, &Catalog::GetObject, request);
}

absl::StatusOr<v1::Object> Client::UpdateObject(const v1::UpdateObjectRequest& request) {
  return Call<v1::Object>(*stubs_->catalog, &Catalog::UpdateObject, request);
}

absl::Status Client::DeleteObject(const std::string& name, bool force) {
  v1::DeleteObjectRequest request;
  request.set_name(name);
  request.set_force(force);
  return Call<google::protobuf::Empty>(*stubs_->catalog, &Catalog::DeleteObject, request).status();
}

absl::StatusOr<v1::StablePose> Client::CreateStablePose(
    const v1::CreateStablePoseRequest& request) {
  return Call<v1::StablePose>(*stubs_->catalog, &Catalog::CreateStablePose, request);
}

absl::StatusOr<v1::StablePose> Client::UpdateStablePose(
    const v1::UpdateStablePoseRequest& request) {
  return Call<v1::StablePose>(*stubs_->catalog, &Catalog::UpdateStablePose, request);
}

absl::StatusOr<v1::ReportGraspOutcomeResponse> Client::ReportGraspOutcome(
    const v1::ReportGraspOutcomeRequest& request) {
  return Call<v1::ReportGraspOutcomeResponse>(*stubs_->catalog, &Catalog::ReportGraspOutcome,
                                              request);
}

absl::StatusOr<v1::StablePose> Client::GetStablePose(const std::string& name) {
  v1::GetStablePoseRequest request;
  request.set_name(name);
  return Call<v1::StablePose>(*stubs_->catalog, &Catalog::GetStablePose, request);
}

absl::StatusOr<v1::View> Client::GetView(const std::string& name) {
  v1::GetViewRequest request;
  request.set_name(name);
  request.set_detail(v1::VIEW_DETAIL_FULL);
  return Call<v1::View>(*stubs_->catalog, &Catalog::GetView, request);
}

absl::Status Client::DeleteView(const std::string& name) {
  v1::DeleteViewRequest request;
  request.set_name(name);
  return Call<google::protobuf::Empty>(*stubs_->catalog, &Catalog::DeleteView, request).status();
}

absl::StatusOr<std::vector<v1::Object>> Client::ListObjects() {
  std::vector<v1::Object> out;
  v1::ListObjectsRequest request;
  absl::Status status = ForEachPage(
      [&](const std::string& token) {
        request.set_page_token(token);
        return Call<v1::ListObjectsResponse>(*stubs_->catalog, &Catalog::ListObjects, request);
      },
      [&](v1::ListObjectsResponse page) { Append(*page.mutable_objects(), &out); });
  if (!status.ok()) return status;
  return out;
}

absl::StatusOr<std::vector<v1::StablePose>> Client::ListStablePoses(const std::string& object) {
  std::vector<v1::StablePose> out;
  v1::ListStablePosesRequest request;
  request.set_parent(object);
  absl::Status status = ForEachPage(
      [&](const std::string& token) {
        request.set_page_token(token);
        return Call<v1::ListStablePosesResponse>(*stubs_->catalog, &Catalog::ListStablePoses,
                                                 request);
      },
      [&](v1::ListStablePosesResponse page) { Append(*page.mutable_stable_poses(), &out); });
  if (!status.ok()) return status;
  return out;
}

absl::StatusOr<std::vector<v1::View>> Client::ListViews(const std::string& stable_pose) {
  std::vector<v1::View> out;
  v1::ListViewsRequest request;
  request.set_parent(stable_pose);
  request.set_page_size(1000);
  absl::Status status = ForEachPage(
      [&](const std::string& token) {
        request.set_page_token(token);
        return Call<v1::ListViewsResponse>(*stubs_->catalog, &Catalog::ListViews, request);
      },
      [&](v1::ListViewsResponse page) { Append(*page.mutable_views(), &out); });
  if (!status.ok()) return status;
  return out;
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
  if (!status.ok()) return ToStatus(status);
  return response;
}

absl::StatusOr<v1::Cell> Client::CreateCell(const v1::CreateCellRequest& request) {
  return Call<v1::Cell>(*stubs_->cells, &Cells::CreateCell, request);
}

absl::StatusOr<v1::Cell> Client::GetCell(const std::string& name) {
  v1::GetCellRequest request;
  request.set_name(name);
  return Call<v1::Cell>(*stubs_->cells, &Cells::GetCell, request);
}

absl::StatusOr<v1::Cell> Client::UpdateCell(const v1::UpdateCellRequest& request) {
  return Call<v1::Cell>(*stubs_->cells, &Cells::UpdateCell, request);
}

absl::Status Client::DeleteCell(const std::string& name) {
  v1::DeleteCellRequest request;
  request.set_name(name);
  return Call<google::protobuf::Empty>(*stubs_->cells, &Cells::DeleteCell, request).status();
}

absl::StatusOr<std::vector<v1::Cell>> Client::ListCells() {
  std::vector<v1::Cell> out;
  v1::ListCellsRequest request;
  absl::Status status = ForEachPage(
      [&](const std::string& token) {
        request.set_page_token(token);
        return Call<v1::ListCellsResponse>(*stubs_->cells, &Cells::ListCells, request);
      },
      [&](v1::ListCellsResponse page) { Append(*page.mutable_cells(), &out); });
  if (!status.ok()) return status;
  return out;
}

}  // namespace graspdb::client
