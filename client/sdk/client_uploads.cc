// Bulk uploads.

#include "client/sdk/client_call.h"

namespace graspdb::client {
namespace {

using Uploads = v1::UploadService::Stub;

// Requests without a response. A view takes the server longer than its way there.
constexpr int kMaxPending = 8;

}  // namespace

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

}  // namespace graspdb::client
