// Teaching views: the compute-intensive part of CatalogService.
#include <string>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "server/base/background.h"
#include "server/base/errors.h"
#include "server/calls/call_guard.h"
#include "server/calls/handle.h"
#include "server/catalogue/catalog_service.h"
#include "server/requests/request_limits.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {

absl::Status CatalogService::UploadOne(const v1::UploadViewsRequest& request,
                                       const recognition::IsCancelled& is_cancelled,
                                       v1::UploadViewsResponse* response) {
  RETURN_IF_ERROR(CheckLimits(request));
  absl::StatusOr<storage::StablePoseName> parent = storage::ParseStablePoseName(request.parent());
  if (!parent.ok()) return AtField("parent", parent.status());
  RETURN_IF_ERROR(AtField("view_id", storage::ValidateResourceId(request.view_id())));
  const std::string name =
      storage::MakeViewName(parent->object_id, parent->stable_pose_id, request.view_id());

  // Existing views are not computed again.
  absl::StatusOr<storage::ViewRecord> existing = context_.catalogue.GetView(name);
  const std::string digest = UploadDigest(request);
  if (existing.ok() && existing->content_digest() == digest) {
    response->set_existing_count(response->existing_count() + 1);
    return absl::OkStatus();
  }
  RETURN_IF_ERROR(context_.catalogue.GetStablePose(request.parent()).status());
  ASSIGN_OR_RETURN(
      const auto memory,
      context_.request_memory.Reserve(RequestMemory::kBytesPerWireByte * request.ByteSizeLong()));
  ASSIGN_OR_RETURN(Admission::Ticket ticket, context_.teaching.Enter(is_cancelled));
  ASSIGN_OR_RETURN(storage::NewView view,
                   MakeView(request, context_.parameters, context_.limits, is_cancelled));
  view.record.set_name(name);
  view.record.set_content_digest(digest);
  ASSIGN_OR_RETURN(storage::PutViewOutcome outcome, context_.catalogue.PutView(view));
  if (outcome == storage::PutViewOutcome::kCreated) {
    response->set_created_count(response->created_count() + 1);
  } else {
    response->set_existing_count(response->existing_count() + 1);
  }
  return absl::OkStatus();
}

absl::Status CatalogService::UploadAll(CallGuard& guard,
                                       const recognition::IsCancelled& is_cancelled,
                                       grpc::ServerReader<v1::UploadViewsRequest>* reader,
                                       v1::UploadViewsResponse* response) {
  for (;;) {
    // Not kept while the stream waits for the next one: nothing counts its memory then.
    v1::UploadViewsRequest request;
    if (!reader->Read(&request)) break;
    guard.NoteMessage();
    guard.NoteResource(request.parent());
    absl::Status status = UploadOne(request, is_cancelled, response);
    if (status.ok()) continue;
    // Names that are too long for any resource must not displace the reason.
    absl::Status named(status.code(),
                       absl::StrCat("view \"", BoundedText(request.view_id(), 66), "\" of ",
                                    BoundedText(request.parent(), 160), ": ", status.message()));
    status.ForEachPayload(
        [&](absl::string_view url, const absl::Cord& payload) { named.SetPayload(url, payload); });
    return named;
  }
  response->set_catalog_revision(context_.catalogue.revision());
  return absl::OkStatus();
}

grpc::Status CatalogService::UploadViews(grpc::ServerContext* context,
                                         grpc::ServerReader<v1::UploadViewsRequest>* reader,
                                         v1::UploadViewsResponse* response) {
  return Handle(*context, "UploadViews", [&] {
    AbandonedWatch watch(*context);
    const auto is_cancelled = [&] { return watch.IsAbandoned(); };
    return InBackground([&]() -> absl::Status {
      absl::Status status = UploadAll(*CallGuard::Of(*context), is_cancelled, reader, response);
      // Not by the watch, which misses a cancellation of the last milliseconds.
      if (status.ok() && IsAbandoned(*context)) {
        return absl::CancelledError("the upload was cancelled");
      }
      return status;
    });
  });
}

}  // namespace graspdb::server
