// UploadService over the storage.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "graspdb/v1/upload_service.grpc.pb.h"
#include "program/base/monotonic_cond_var.h"
#include "recognition/recognizer.h"
#include "server/calls/admission.h"
#include "server/calls/memory_budget.h"
#include "server/catalogue/teacher.h"
#include "storage/catalogue/catalogue.h"
#include "storage/uploads/uploads.h"

namespace graspdb::server {

// Counts views over the last half minute. Not thread-safe.
class UploadRate {
 public:
  using Clock = std::chrono::steady_clock;

  void Add(Clock::time_point now) {
    if (counts_.empty() || now - counts_.back().since >= kStep) counts_.push_back({now, 0});
    ++counts_.back().views;
    Forget(now);
  }

  double PerSecond(Clock::time_point now) {
    Forget(now);
    std::int64_t views = 0;
    for (const Count& count : counts_) views += count.views;
    if (views == 0) return 0;
    return static_cast<double>(views) /
           std::chrono::duration<double>(
               std::max<Clock::duration>(kStep, now - counts_.front().since))
               .count();
  }

 private:
  static constexpr std::chrono::seconds kStep{1};
  static constexpr std::chrono::seconds kSpan{30};

  struct Count {
    Clock::time_point since;
    std::int64_t views;
  };

  void Forget(Clock::time_point now) {
    while (!counts_.empty() && now - counts_.front().since > kSpan) counts_.pop_front();
  }

  std::deque<Count> counts_;  // of a step each
};

// Dependencies of the handlers; all of them outlive the handlers.
struct UploadContext {
  storage::Catalogue& catalogue;
  Admission& teaching;
  RequestMemory& request_memory;
  recognition::RecognitionParameters parameters;
  TeachLimits limits;
};

// Thread-safe.
class UploadService final : public v1::UploadService::Service {
 public:
  explicit UploadService(UploadContext context) : context_(std::move(context)) {}

  grpc::Status CreateUpload(grpc::ServerContext* context, const v1::CreateUploadRequest* request,
                            v1::Upload* response) override;
  grpc::Status GetUpload(grpc::ServerContext* context, const v1::GetUploadRequest* request,
                         v1::Upload* response) override;
  grpc::Status ListUploads(grpc::ServerContext* context, const v1::ListUploadsRequest* request,
                           v1::ListUploadsResponse* response) override;
  grpc::Status ListUploadViews(grpc::ServerContext* context,
                               const v1::ListUploadViewsRequest* request,
                               v1::ListUploadViewsResponse* response) override;
  using Stream =
      grpc::ServerReaderWriter<v1::WriteUploadViewsResponse, v1::WriteUploadViewsRequest>;
  grpc::Status WriteUploadViews(grpc::ServerContext* context, Stream* stream) override;
  grpc::Status CommitUpload(grpc::ServerContext* context, const v1::CommitUploadRequest* request,
                            v1::Upload* response) override;
  grpc::Status DeleteUpload(grpc::ServerContext* context, const v1::DeleteUploadRequest* request,
                            google::protobuf::Empty* response) override;

 private:
  storage::Uploads& uploads() { return context_.catalogue.uploads(); }
  // The uploads of a stream by name, as they were when it first sent a view to them: another upload
  // may have the name later.
  using StreamUploads = std::map<std::string, storage::UploadRecord>;
  absl::Status Write(const v1::WriteUploadViewsRequest& request, StreamUploads& known,
                     const recognition::IsCancelled& is_cancelled,
                     v1::WriteUploadViewsResponse* response);
  // Counts a view for the rate of its upload.
  void CountSent(const std::string& upload);
  absl::StatusOr<storage::NewView> MakeViewOf(const v1::UploadViewsRequest& request,
                                              const recognition::IsCancelled& is_cancelled);
  absl::StatusOr<v1::Upload> ToProto(const storage::UploadRecord& record);
  // DescribeStaged() of one upload at a time, so that calls at once do not describe the same views,
  // with an unpacked cloud each. CANCELLED also while it waits.
  absl::Status Describe(const storage::UploadRecord& upload,
                        const recognition::IsCancelled& is_cancelled);
  // Describes the views that were staged with other parameters, and commits the upload. CANCELLED
  // before it is committed only; what is described then stays described.
  absl::StatusOr<storage::UploadRecord> Commit(const v1::CommitUploadRequest& request,
                                               const recognition::IsCancelled& is_cancelled);

  UploadContext context_;
  absl::Mutex mutex_;
  bool is_describing_ ABSL_GUARDED_BY(mutex_) = false;
  MonotonicCondVar description_ended_;
  std::map<std::string, UploadRate> rates_ ABSL_GUARDED_BY(mutex_);  // of open uploads
};

}  // namespace graspdb::server
