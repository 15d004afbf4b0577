// CatalogService over the storage.
#pragma once

#include <functional>

#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "recognition/recognizer.h"
#include "server/backups/catalogue_backups.h"
#include "server/calls/admission.h"
#include "server/calls/call_guard.h"
#include "server/calls/memory_budget.h"
#include "server/catalogue/teacher.h"
#include "server/live/live_catalogue.h"
#include "server/live/view_cloud_cache.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Dependencies of the catalogue's handlers; all of them outlive the handlers.
struct CatalogContext {
  storage::Catalogue& catalogue;
  const LiveCatalogue& live;
  Admission& teaching;
  const ViewCloudCache& clouds;
  MemoryShares memory;
  RequestMemory& request_memory;
  recognition::RecognitionParameters parameters;
  TeachLimits limits;
  const CatalogueBackups* backups = nullptr;           // null: the server has no folder for them
  std::function<v1::ServerState()> server_state = {};  // thread-safe; empty: it is not reported
};

// Thread-safe.
class CatalogService final : public v1::CatalogService::Service {
 public:
  explicit CatalogService(CatalogContext context);

  grpc::Status CreateObject(grpc::ServerContext* context, const v1::CreateObjectRequest* request,
                            v1::Object* response) override;
  grpc::Status GetObject(grpc::ServerContext* context, const v1::GetObjectRequest* request,
                         v1::Object* response) override;
  grpc::Status ListObjects(grpc::ServerContext* context, const v1::ListObjectsRequest* request,
                           v1::ListObjectsResponse* response) override;
  grpc::Status UpdateObject(grpc::ServerContext* context, const v1::UpdateObjectRequest* request,
                            v1::Object* response) override;
  grpc::Status DeleteObject(grpc::ServerContext* context, const v1::DeleteObjectRequest* request,
                            google::protobuf::Empty* response) override;
  grpc::Status CreateStablePose(grpc::ServerContext* context,
                                const v1::CreateStablePoseRequest* request,
                                v1::StablePose* response) override;
  grpc::Status GetStablePose(grpc::ServerContext* context, const v1::GetStablePoseRequest* request,
                             v1::StablePose* response) override;
  grpc::Status ListStablePoses(grpc::ServerContext* context,
                               const v1::ListStablePosesRequest* request,
                               v1::ListStablePosesResponse* response) override;
  grpc::Status UpdateStablePose(grpc::ServerContext* context,
                                const v1::UpdateStablePoseRequest* request,
                                v1::StablePose* response) override;
  grpc::Status DeleteStablePose(grpc::ServerContext* context,
                                const v1::DeleteStablePoseRequest* request,
                                google::protobuf::Empty* response) override;
  grpc::Status GetView(grpc::ServerContext* context, const v1::GetViewRequest* request,
                       v1::View* response) override;
  grpc::Status ListViews(grpc::ServerContext* context, const v1::ListViewsRequest* request,
                         v1::ListViewsResponse* response) override;
  grpc::Status DeleteView(grpc::ServerContext* context, const v1::DeleteViewRequest* request,
                          google::protobuf::Empty* response) override;
  grpc::Status UploadViews(grpc::ServerContext* context,
                           grpc::ServerReader<v1::UploadViewsRequest>* reader,
                           v1::UploadViewsResponse* response) override;
  grpc::Status ReportGraspOutcome(grpc::ServerContext* context,
                                  const v1::ReportGraspOutcomeRequest* request,
                                  v1::ReportGraspOutcomeResponse* response) override;
  grpc::Status GetCatalogStatus(grpc::ServerContext* context,
                                const v1::GetCatalogStatusRequest* request,
                                v1::CatalogStatus* response) override;

 private:
  absl::Status UploadOne(const v1::UploadViewsRequest& request,
                         const recognition::IsCancelled& is_cancelled,
                         v1::UploadViewsResponse* response);
  absl::Status UploadAll(CallGuard& guard, const recognition::IsCancelled& is_cancelled,
                         grpc::ServerReader<v1::UploadViewsRequest>* reader,
                         v1::UploadViewsResponse* response);

  CatalogContext context_;
  Admission describing_{1, 16};  // views for VIEW_DETAIL_DESCRIBED: some milliseconds each
  std::chrono::steady_clock::time_point start_;
};

}  // namespace graspdb::server
