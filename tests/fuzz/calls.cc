#include "tests/fuzz/calls.h"

#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

constexpr int kPage = 1000;  // more than a sequence makes

using Catalog = v1::CatalogService::Stub;
using CellStub = v1::CellService::Stub;
using UploadStub = v1::UploadService::Stub;
using HistoryStub = v1::ObjectHistoryService::Stub;

template <typename Stub, typename Request, typename Response>
grpc::Status Call(Stub& stub,
                  grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                  const Request& request, Response* response) {
  grpc::ClientContext context;
  return (stub.*method)(&context, request, response);
}

template <typename Stub, typename Request, typename Response>
void CallAndCheck(Stub& stub,
                  grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                  const Request& request) {
  Response ignored;
  RequireAnswer(Call(stub, method, request, &ignored));
}

void StreamAndCheck(v1::RecognitionService::Stub& stub, const Frames& frames) {
  grpc::ClientContext context;
  const auto stream = stub.RecognizeStream(&context);
  int written = 0;
  for (const v1::RecognizeStreamRequest& frame : frames.frames()) {
    if (!stream->Write(frame)) break;
    ++written;
  }
  stream->WritesDone();
  v1::RecognizeStreamResponse response;
  int answered = 0;
  while (stream->Read(&response)) ++answered;
  const grpc::Status status = stream->Finish();
  RequireAnswer(status);
  Require(!status.ok() || answered == written, "an answer to each frame");
}

void WriteAndCheck(UploadStub& stub, const BulkViews& views) {
  grpc::ClientContext context;
  const auto stream = stub.WriteUploadViews(&context);
  v1::WriteUploadViewsResponse response;
  bool answered = true;
  for (const v1::WriteUploadViewsRequest& view : views.views()) {
    answered = stream->Write(view) && stream->Read(&response);
    if (!answered) break;
  }
  stream->WritesDone();
  const grpc::Status status = stream->Finish();
  RequireAnswer(status);
  Require(!status.ok() || answered, "a response to each view");
}

void ProposeAndCheck(v1::RecognitionService::Stub& stub,
                     const v1::ProposeThresholdsRequest& request) {
  grpc::ClientContext context;
  const auto stream = stub.ProposeThresholds(&context, request);
  v1::ProposeThresholdsResponse response;
  while (stream->Read(&response)) {
  }
  RequireAnswer(stream->Finish());
}

// A call of the catalogue's service, or none.
void CallCatalog(FuzzServer& server, const Operation& o) {
  Catalog& catalog = server.catalog();
  v1::UploadViewsResponse uploaded;
  switch (o.request_case()) {
    case Operation::kCreateObject:
      return CallAndCheck(catalog, &Catalog::CreateObject, o.create_object());
    case Operation::kGetObject:
      return CallAndCheck(catalog, &Catalog::GetObject, o.get_object());
    case Operation::kListObjects:
      return CallAndCheck(catalog, &Catalog::ListObjects, o.list_objects());
    case Operation::kUpdateObject:
      return CallAndCheck(catalog, &Catalog::UpdateObject, o.update_object());
    case Operation::kDeleteObject:
      return CallAndCheck(catalog, &Catalog::DeleteObject, o.delete_object());
    case Operation::kCreateStablePose:
      return CallAndCheck(catalog, &Catalog::CreateStablePose, o.create_stable_pose());
    case Operation::kGetStablePose:
      return CallAndCheck(catalog, &Catalog::GetStablePose, o.get_stable_pose());
    case Operation::kListStablePoses:
      return CallAndCheck(catalog, &Catalog::ListStablePoses, o.list_stable_poses());
    case Operation::kUpdateStablePose:
      return CallAndCheck(catalog, &Catalog::UpdateStablePose, o.update_stable_pose());
    case Operation::kDeleteStablePose:
      return CallAndCheck(catalog, &Catalog::DeleteStablePose, o.delete_stable_pose());
    case Operation::kGetView:
      return CallAndCheck(catalog, &Catalog::GetView, o.get_view());
    case Operation::kListViews:
      return CallAndCheck(catalog, &Catalog::ListViews, o.list_views());
    case Operation::kDeleteView:
      return CallAndCheck(catalog, &Catalog::DeleteView, o.delete_view());
    case Operation::kUploadViews:
      return RequireAnswer(server.Upload(o.upload_views().views(), &uploaded));
    case Operation::kReportGraspOutcome:
      return CallAndCheck(catalog, &Catalog::ReportGraspOutcome, o.report_grasp_outcome());
    case Operation::kGetCatalogStatus:
      return CallAndCheck(catalog, &Catalog::GetCatalogStatus, o.get_catalog_status());
    default:
      Require(o.request_case() == Operation::REQUEST_NOT_SET, "each operation is called");
  }
}

}  // namespace

void RequireAnswer(const grpc::Status& status) {
  const bool fault = status.error_code() == grpc::StatusCode::INTERNAL ||
                     status.error_code() == grpc::StatusCode::UNKNOWN ||
                     status.error_code() == grpc::StatusCode::UNAVAILABLE ||
                     status.error_code() == grpc::StatusCode::DATA_LOSS;
  if (fault) std::fprintf(stderr, "%s\n", status.error_message().c_str());
  Require(!fault, "an answer or a refusal");
}

void Calls::Do(const Operation& o) {
  CellStub& cells = server_.cells();
  UploadStub& uploads = server_.uploads();
  HistoryStub& history = server_.history();
  switch (o.request_case()) {
    case Operation::kCreateCell:
      return CallAndCheck(cells, &CellStub::CreateCell, o.create_cell());
    case Operation::kGetCell:
      return CallAndCheck(cells, &CellStub::GetCell, o.get_cell());
    case Operation::kListCells:
      return CallAndCheck(cells, &CellStub::ListCells, o.list_cells());
    case Operation::kUpdateCell:
      return CallAndCheck(cells, &CellStub::UpdateCell, o.update_cell());
    case Operation::kDeleteCell:
      return CallAndCheck(cells, &CellStub::DeleteCell, o.delete_cell());
    case Operation::kRecognize:
      return CallAndCheck(server_.recognition(), &v1::RecognitionService::Stub::Recognize,
                          o.recognize());
    case Operation::kRecognizeStream:
      return StreamAndCheck(server_.recognition(), o.recognize_stream());
    case Operation::kFindLookAlikes:
      return CallAndCheck(server_.recognition(), &v1::RecognitionService::Stub::FindLookAlikes,
                          o.find_look_alikes());
    case Operation::kProposeThresholds:
      return ProposeAndCheck(server_.recognition(), o.propose_thresholds());
    case Operation::kCreateUpload:
      return CallAndCheck(uploads, &UploadStub::CreateUpload, o.create_upload());
    case Operation::kGetUpload:
      return CallAndCheck(uploads, &UploadStub::GetUpload, o.get_upload());
    case Operation::kListUploads:
      return CallAndCheck(uploads, &UploadStub::ListUploads, o.list_uploads());
    case Operation::kListUploadViews:
      return CallAndCheck(uploads, &UploadStub::ListUploadViews, o.list_upload_views());
    case Operation::kWriteUploadViews:
      return WriteAndCheck(uploads, o.write_upload_views());
    case Operation::kCommitUpload:
      return CallAndCheck(uploads, &UploadStub::CommitUpload, o.commit_upload());
    case Operation::kDeleteUpload:
      return CallAndCheck(uploads, &UploadStub::DeleteUpload, o.delete_upload());
    case Operation::kListDeletedObjects:
      return CallAndCheck(history, &HistoryStub::ListDeletedObjects, o.list_deleted_objects());
    case Operation::kGetDeletedObject:
      return CallAndCheck(history, &HistoryStub::GetDeletedObject, o.get_deleted_object());
    case Operation::kUndeleteObject:
      return CallAndCheck(history, &HistoryStub::UndeleteObject, o.undelete_object());
    case Operation::kPurgeObject:
      return CallAndCheck(history, &HistoryStub::PurgeObject, o.purge_object());
    case Operation::kListObjectRevisions:
      return CallAndCheck(history, &HistoryStub::ListObjectRevisions, o.list_object_revisions());
    case Operation::kRestoreObject:
      return CallAndCheck(history, &HistoryStub::RestoreObject, o.restore_object());
    default:
      return CallCatalog(server_, o);
  }
}

v1::ListObjectsResponse Calls::Objects() {
  v1::ListObjectsRequest request;
  request.set_page_size(kPage);
  v1::ListObjectsResponse response;
  Require(Call(server_.catalog(), &Catalog::ListObjects, request, &response).ok(),
          "objects are listed");
  return response;
}

v1::ListCellsResponse Calls::Cells() {
  v1::ListCellsRequest request;
  request.set_page_size(kPage);
  v1::ListCellsResponse response;
  Require(Call(server_.cells(), &CellStub::ListCells, request, &response).ok(), "cells are listed");
  return response;
}

std::vector<std::string> Calls::Listed() {
  std::vector<std::string> names;
  const v1::ListObjectsResponse objects = Objects();
  const v1::ListCellsResponse cells = Cells();
  for (const v1::Object& object : objects.objects()) names.push_back(object.name());
  for (const v1::Cell& cell : cells.cells()) names.push_back(cell.name());
  return names;
}

void Calls::RequireCounted() {
  v1::CatalogStatus status;
  Require(
      Call(server_.catalog(), &Catalog::GetCatalogStatus, v1::GetCatalogStatusRequest(), &status)
          .ok(),
      "a status");
  Require(status.catalog_revision() >= revision_, "a revision that does not go back");
  const bool has_changed = status.catalog_revision() != revision_;
  revision_ = status.catalog_revision();
  // Listing takes longer than most calls.
  if (!has_changed) return;
  Require(status.object_count() == Objects().objects_size(), "as many objects as are counted");
}

void Calls::RequireViewsReadable(const std::string& stable_pose) {
  v1::ListViewsRequest request;
  request.set_parent(stable_pose);
  request.set_page_size(kPage);
  v1::ListViewsResponse views;
  Require(Call(server_.catalog(), &Catalog::ListViews, request, &views).ok(), "views are listed");
  for (const v1::View& view : views.views()) {
    v1::GetViewRequest get;
    get.set_name(view.name());
    get.set_detail(v1::VIEW_DETAIL_FULL);
    v1::View got;
    Require(Call(server_.catalog(), &Catalog::GetView, get, &got).ok(), "a view is read");
  }
}

void Calls::RequireReadable() {
  const v1::ListObjectsResponse objects = Objects();
  for (const v1::Object& object : objects.objects()) {
    v1::ListStablePosesRequest request;
    request.set_parent(object.name());
    request.set_page_size(kPage);
    v1::ListStablePosesResponse poses;
    Require(Call(server_.catalog(), &Catalog::ListStablePoses, request, &poses).ok(),
            "stable poses are listed");
    for (const v1::StablePose& pose : poses.stable_poses()) RequireViewsReadable(pose.name());
  }
}

void Calls::DeleteAll() {
  google::protobuf::Empty nothing;
  const v1::ListObjectsResponse objects = Objects();
  for (const v1::Object& object : objects.objects()) {
    v1::DeleteObjectRequest request;
    request.set_name(object.name());
    request.set_force(true);
    Require(Call(server_.catalog(), &Catalog::DeleteObject, request, &nothing).ok(),
            "an object is deleted");
  }
  v1::ListDeletedObjectsRequest list_deleted;
  list_deleted.set_page_size(kPage);
  v1::ListDeletedObjectsResponse deleted;
  Require(Call(server_.history(), &HistoryStub::ListDeletedObjects, list_deleted, &deleted).ok(),
          "deleted objects are listed");
  for (const v1::Object& object : deleted.objects()) {
    v1::PurgeObjectRequest request;
    request.set_name(object.name());
    Require(Call(server_.history(), &HistoryStub::PurgeObject, request, &nothing).ok(),
            "an object is purged");
  }
  const v1::ListCellsResponse cells = Cells();
  for (const v1::Cell& cell : cells.cells()) {
    v1::DeleteCellRequest request;
    request.set_name(cell.name());
    Require(Call(server_.cells(), &CellStub::DeleteCell, request, &nothing).ok(),
            "a cell is deleted");
  }
  v1::ListUploadsRequest list;
  list.set_page_size(kPage);
  v1::ListUploadsResponse uploads;
  Require(Call(server_.uploads(), &UploadStub::ListUploads, list, &uploads).ok(),
          "uploads are listed");
  for (const v1::Upload& upload : uploads.uploads()) {
    v1::DeleteUploadRequest request;
    request.set_name(upload.name());
    Require(Call(server_.uploads(), &UploadStub::DeleteUpload, request, &nothing).ok(),
            "an upload is deleted");
  }
}

}  // namespace graspdb::fuzz
