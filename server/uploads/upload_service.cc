#include "server/uploads/upload_service.h"

#include <string>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "program/base/monotonic_time.h"
#include "server/base/background.h"
#include "server/base/errors.h"
#include "server/calls/handle.h"
#include "server/live/load_views.h"
#include "server/requests/respond.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {
namespace {

// Between checks for a cancellation while another upload is described.
constexpr absl::Duration kCancellationPeriod = absl::Milliseconds(20);

}  // namespace

absl::StatusOr<v1::Upload> UploadService::ToProto(const storage::UploadRecord& record) {
  v1::Upload out;
  out.set_name(record.name());
  out.set_state(record.has_commit_time() ? v1::UPLOAD_STATE_COMMITTED : v1::UPLOAD_STATE_OPEN);
  out.set_replace(record.replace());
  out.set_expected_view_count(record.expected_view_count());
  *out.mutable_create_time() = record.create_time();
  if (record.has_commit_time()) {
    out.set_commit_revision(record.commit_revision());
    *out.mutable_commit_time() = record.commit_time();
    out.set_created_count(record.created_count());
    out.set_existing_count(record.existing_count());
    out.set_replaced_count(record.replaced_count());
    out.set_failed_view_count(record.failed_count());
    return out;
  }
  ASSIGN_OR_RETURN(const auto counts, uploads().CountsOf(record));
  out.set_staged_view_count(counts.views);
  out.set_failed_view_count(counts.errors);
  absl::MutexLock lock(&mutex_);
  const auto rate = rates_.find(record.name());
  if (rate == rates_.end()) return out;
  out.set_views_per_second(rate->second.PerSecond(UploadRate::Clock::now()));
  const std::int64_t left = record.expected_view_count() - counts.views - counts.errors;
  if (left >= 0 && record.expected_view_count() > 0 && out.views_per_second() > 0) {
    out.set_time_left_s(static_cast<double>(left) / out.views_per_second());
  }
  return out;
}

grpc::Status UploadService::CreateUpload(grpc::ServerContext* context,
                                         const v1::CreateUploadRequest* request,
                                         v1::Upload* response) {
  return Handle(*context, "CreateUpload", *request, [&]() -> absl::Status {
    RETURN_IF_ERROR(AtField("upload_id", storage::ValidateResourceId(request->upload_id())));
    if (request->upload().expected_view_count() < 0) {
      return InvalidField("upload.expected_view_count", "is negative");
    }
    storage::UploadRecord wanted;
    wanted.set_name(storage::MakeUploadName(request->upload_id()));
    wanted.set_replace(request->upload().replace());
    wanted.set_expected_view_count(request->upload().expected_view_count());
    ASSIGN_OR_RETURN(const auto created, uploads().Create(wanted, absl::Now()));
    return Respond("upload_id", ToProto(created), response);
  });
}

grpc::Status UploadService::GetUpload(grpc::ServerContext* context,
                                      const v1::GetUploadRequest* request, v1::Upload* response) {
  return Handle(*context, "GetUpload", *request, [&]() -> absl::Status {
    const auto record = uploads().Get(request->name());
    if (!record.ok()) return AtField("name", record.status());
    return Respond("name", ToProto(*record), response);
  });
}

grpc::Status UploadService::ListUploads(grpc::ServerContext* context,
                                        const v1::ListUploadsRequest* request,
                                        v1::ListUploadsResponse* response) {
  return Handle(*context, "ListUploads", *request, [&] {
    absl::Status status;
    const auto list = [&](std::size_t size, const std::string& after) {
      return uploads().List(size, after);
    };
    const auto add = [&](const storage::UploadRecord& record) {
      auto upload = ToProto(record);
      status.Update(upload.status());
      if (upload.ok()) *response->add_uploads() = *std::move(upload);
    };
    status.Update(RespondPage(*request, "uploads/", list, add, response));
    return status;
  });
}

grpc::Status UploadService::ListUploadViews(grpc::ServerContext* context,
                                            const v1::ListUploadViewsRequest* request,
                                            v1::ListUploadViewsResponse* response) {
  return Handle(*context, "ListUploadViews", *request, [&]() -> absl::Status {
    const auto record = uploads().Get(request->parent());
    if (!record.ok()) return AtField("parent", record.status());
    const auto list = [&](std::size_t size, const std::string& after) {
      return uploads().ListItems(*record, size, after);
    };
    const auto add = [&](const storage::StagedItem& item) {
      v1::UploadView& view = *response->add_views();
      view.set_name(item.view_name);
      if (!item.error.ok()) *view.mutable_error() = ToRpcStatus(item.error);
    };
    return RespondPage(*request, "objects/", list, add, response);
  });
}

absl::Status UploadService::Describe(const storage::UploadRecord& upload,
                                     const recognition::IsCancelled& is_cancelled) {
  {
    absl::MutexLock lock(&mutex_);
    while (is_describing_) {
      if (is_cancelled()) return absl::CancelledError(std::string(kCommitCancelled));
      description_ended_.WaitUntil(&mutex_, MonotonicTime::Now() + kCancellationPeriod);
    }
    is_describing_ = true;
  }
  const absl::Cleanup end = [this] {  // also where there is no memory for it
    absl::MutexLock lock(&mutex_);
    is_describing_ = false;
    description_ended_.SignalAll();
  };
  return InBackground([&] {
    return DescribeStaged(context_.catalogue, upload, context_.parameters.descriptor, is_cancelled);
  });
}

absl::StatusOr<storage::UploadRecord> UploadService::Commit(
    const v1::CommitUploadRequest& request, const recognition::IsCancelled& is_cancelled) {
  auto upload = uploads().Get(request.name());
  if (!upload.ok() || upload->has_commit_time()) return upload;
  if (!request.skip_failed()) {
    RETURN_IF_ERROR(uploads().CheckNoErrors(*upload));
  }
  // Before the commit, as it may take minutes: so it can be interrupted, and all views are
  // recognised from the same revision on. Views that are staged meanwhile have the descriptor.
  absl::Status described = Describe(*upload, is_cancelled);
  if (described.ok()) return uploads().Commit(*upload, request.skip_failed(), is_cancelled);
  // Another call may have committed it meanwhile.
  auto record = uploads().Get(request.name());
  if (record.ok() && record->has_commit_time()) return record;
  return described;
}

grpc::Status UploadService::CommitUpload(grpc::ServerContext* context,
                                         const v1::CommitUploadRequest* request,
                                         v1::Upload* response) {
  return Handle(*context, "CommitUpload", *request, [&]() -> absl::Status {
    // Not by an AbandonedWatch: it is called rarely, and what it misses would be published.
    const auto record = Commit(*request, [&] { return IsAbandoned(*context); });
    if (!record.ok()) return AtField("name", record.status());
    {
      absl::MutexLock lock(&mutex_);
      rates_.erase(request->name());
    }
    return Respond("name", ToProto(*record), response);
  });
}

grpc::Status UploadService::DeleteUpload(grpc::ServerContext* context,
                                         const v1::DeleteUploadRequest* request,
                                         google::protobuf::Empty* /*response*/) {
  return Handle(*context, "DeleteUpload", *request, [&] {
    absl::Status deleted = AtField("name", uploads().Delete(request->name()));
    absl::MutexLock lock(&mutex_);
    rates_.erase(request->name());
    return deleted;
  });
}

}  // namespace graspdb::server
