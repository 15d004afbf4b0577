// Views of bulk uploads: the compute-intensive part of UploadService.
#include <iterator>
#include <string>

#include "base/status_macros.h"
#include "server/base/background.h"
#include "server/base/errors.h"
#include "server/calls/call_guard.h"
#include "server/calls/handle.h"
#include "server/requests/request_limits.h"
#include "server/uploads/upload_service.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {
namespace {

// Whether the view is wrong, and not the server short of something.
bool IsErrorOfView(const absl::Status& status) {
  return absl::IsInvalidArgument(status) || absl::IsFailedPrecondition(status) ||
         absl::IsNotFound(status) || absl::IsAlreadyExists(status) || absl::IsOutOfRange(status);
}

// The name of the view, or an empty one.
std::string NameOf(const v1::UploadViewsRequest& request) {
  const auto parent = storage::ParseStablePoseName(request.parent());
  if (!parent.ok() || !storage::ValidateResourceId(request.view_id()).ok()) return "";
  return storage::MakeViewName(parent->object_id, parent->stable_pose_id, request.view_id());
}

}  // namespace

// Errors as UploadViews.
absl::StatusOr<storage::NewView> UploadService::MakeViewOf(
    const v1::UploadViewsRequest& request, const recognition::IsCancelled& is_cancelled) {
  RETURN_IF_ERROR(CheckLimits(request));
  absl::Status status = AtField("parent", storage::ParseStablePoseName(request.parent()).status());
  status.Update(AtField("view_id", storage::ValidateResourceId(request.view_id())));
  if (!status.ok()) return status;
  RETURN_IF_ERROR(context_.catalogue.GetStablePose(request.parent()).status());
  ASSIGN_OR_RETURN(
      const auto memory,
      context_.request_memory.Reserve(RequestMemory::kBytesPerWireByte * request.ByteSizeLong()));
  ASSIGN_OR_RETURN(const Admission::Ticket ticket, context_.teaching.Enter(is_cancelled));
  return MakeView(request, context_.parameters, context_.limits, is_cancelled);
}

absl::Status UploadService::Write(const v1::WriteUploadViewsRequest& request, StreamUploads& known,
                                  const recognition::IsCancelled& is_cancelled,
                                  v1::WriteUploadViewsResponse* response) {
  // A view beyond its limits does not end the stream.
  RETURN_IF_ERROR(CheckLength(request.upload(), "upload"));
  const auto open = uploads().GetOpen(request.upload());
  if (!open.ok()) return AtField("upload", open.status());
  const storage::UploadRecord& upload = known.try_emplace(request.upload(), *open).first->second;
  const std::string name = NameOf(request.view());
  response->set_view(name);
  // What is stored already is not computed again.
  const std::string digest = UploadDigest(request.view());
  const auto staged = uploads().DigestOf(upload, name);
  if (absl::IsAborted(staged.status())) return AtField("upload", staged.status());
  const auto stored = context_.catalogue.GetView(name);
  // An error or other content that is staged counts at the commit, whatever the catalogue has.
  const bool is_existing =
      staged.ok() ? *staged == digest
                  : !upload.replace() && stored.ok() && stored->content_digest() == digest;
  if (is_existing) {
    response->set_existing(true);
    return absl::OkStatus();
  }
  absl::StatusOr<storage::NewView> view = MakeViewOf(request.view(), is_cancelled);
  if (!view.ok()) {
    if (!IsErrorOfView(view.status())) return view.status();
    *response->mutable_error() = ToRpcStatus(view.status());
    if (name.empty()) return absl::OkStatus();
    absl::Status kept = uploads().StageError(upload, name, view.status());
    if (kept.ok()) CountSent(request.upload());
    return kept;
  }
  view->record.set_name(name);
  view->record.set_content_digest(digest);
  const auto outcome = uploads().Stage(upload, *view);
  if (absl::IsAlreadyExists(outcome.status())) {
    *response->mutable_error() = ToRpcStatus(outcome.status());
    return absl::OkStatus();
  }
  if (!outcome.ok()) return outcome.status();
  response->set_existing(*outcome == storage::PutViewOutcome::kExisting);
  CountSent(request.upload());
  return absl::OkStatus();
}

void UploadService::CountSent(const std::string& upload) {
  const auto now = UploadRate::Clock::now();
  absl::MutexLock lock(&mutex_);
  const auto [rate, is_new] = rates_.try_emplace(upload);
  // Uploads that expired leave theirs.
  for (auto other = rates_.begin(); is_new && other != rates_.end();) {
    const bool is_old = other != rate && other->second.PerSecond(now) == 0;
    other = is_old ? rates_.erase(other) : std::next(other);
  }
  rate->second.Add(now);
}

grpc::Status UploadService::WriteUploadViews(grpc::ServerContext* context, Stream* stream) {
  return Handle(*context, "WriteUploadViews", [&] {
    AbandonedWatch watch(*context);
    const auto is_cancelled = [&] { return watch.IsAbandoned(); };
    return InBackground([&]() -> absl::Status {
      CallGuard& guard = *CallGuard::Of(*context);
      StreamUploads known;
      for (;;) {
        // Not kept while the stream waits for the next one: nothing counts its memory then.
        v1::WriteUploadViewsRequest request;
        if (!stream->Read(&request)) break;
        guard.NoteMessage();
        guard.NoteResource(request.upload());
        v1::WriteUploadViewsResponse response;
        RETURN_IF_ERROR(Write(request, known, is_cancelled, &response));
        if (!stream->Write(response)) break;
      }
      // Not by the watch, which misses a cancellation of the last milliseconds.
      return IsAbandoned(*context) ? absl::CancelledError("the upload was cancelled")
                                   : absl::OkStatus();
    });
  });
}

}  // namespace graspdb::server
