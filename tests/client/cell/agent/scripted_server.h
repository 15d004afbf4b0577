// A graspdb server with scripted answers, over an in-process channel.
#pragma once

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <string>

#include "absl/synchronization/mutex.h"
#include "client/sdk/client.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/cell_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"

namespace graspdb::client {

class ScriptedServer : private v1::RecognitionService::Service,
                       private v1::CellService::Service,
                       private v1::CatalogService::Service {
 public:
  ScriptedServer();

  Client Connect(ConnectionOptions options = {.timeout = absl::Seconds(5), .retry = false});

  // Changes the script; calls wait for it.
  void Change(const std::function<void(ScriptedServer&)>& change) {
    absl::MutexLock lock(&mutex_);
    change(*this);
  }

  // The script. After the first call, access it only in Change.
  std::function<grpc::Status(const v1::RecognizeRequest&, v1::RecognizeResponse*)> recognize;
  std::function<void(const std::string&)> recognize_id;  // may be empty
  std::function<grpc::Status(v1::Cell*)> get_cell;
  std::function<grpc::Status(v1::ListObjectsResponse*)> list_objects;
  std::function<grpc::Status(const v1::ReportGraspOutcomeRequest&)> report_outcome;
  v1::StablePose stable_pose;  // for GetStablePose and UpdateStablePose
  std::string version = "9.8";

 private:
  grpc::Status Recognize(grpc::ServerContext* context, const v1::RecognizeRequest* request,
                         v1::RecognizeResponse* response) override;
  grpc::Status GetCell(grpc::ServerContext* /*context*/, const v1::GetCellRequest* request,
                       v1::Cell* response) override;
  grpc::Status ListObjects(grpc::ServerContext* /*context*/,
                           const v1::ListObjectsRequest* /*request*/,
                           v1::ListObjectsResponse* response) override;
  grpc::Status GetStablePose(grpc::ServerContext* /*context*/,
                             const v1::GetStablePoseRequest* request,
                             v1::StablePose* response) override;
  grpc::Status UpdateStablePose(grpc::ServerContext* /*context*/,
                                const v1::UpdateStablePoseRequest* request,
                                v1::StablePose* response) override;
  grpc::Status GetCatalogStatus(grpc::ServerContext* /*context*/,
                                const v1::GetCatalogStatusRequest* /*request*/,
                                v1::CatalogStatus* response) override;
  grpc::Status ReportGraspOutcome(grpc::ServerContext* /*context*/,
                                  const v1::ReportGraspOutcomeRequest* request,
                                  v1::ReportGraspOutcomeResponse* response) override;

  absl::Mutex mutex_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace graspdb::client
