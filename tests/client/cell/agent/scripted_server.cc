#include "tests/client/cell/agent/scripted_server.h"

#include "program/log/request_id.h"

namespace graspdb::client {
namespace {

template <typename Script, typename... Arguments>
grpc::Status Play(const Script& script, Arguments&&... arguments) {
  return script ? script(std::forward<Arguments>(arguments)...) : grpc::Status::OK;
}

}  // namespace

ScriptedServer::ScriptedServer() {
  grpc::ServerBuilder builder;
  builder.RegisterService(static_cast<v1::RecognitionService::Service*>(this));
  builder.RegisterService(static_cast<v1::CellService::Service*>(this));
  builder.RegisterService(static_cast<v1::CatalogService::Service*>(this));
  server_ = builder.BuildAndStart();
}

Client ScriptedServer::Connect(ConnectionOptions options) {
  return {server_->InProcessChannel({}), std::move(options)};
}

grpc::Status ScriptedServer::Recognize(grpc::ServerContext* context,
                                       const v1::RecognizeRequest* request,
                                       v1::RecognizeResponse* response) {
  absl::MutexLock lock(&mutex_);
  const auto id = context->client_metadata().find(kRequestIdKey);
  if (recognize_id && id != context->client_metadata().end()) {
    recognize_id(std::string(id->second.data(), id->second.size()));
  }
  return Play(recognize, *request, response);
}

grpc::Status ScriptedServer::GetCell(grpc::ServerContext* /*context*/,
                                     const v1::GetCellRequest* request, v1::Cell* response) {
  absl::MutexLock lock(&mutex_);
  response->set_name(request->name());
  return Play(get_cell, response);
}

grpc::Status ScriptedServer::ListObjects(grpc::ServerContext* /*context*/,
                                         const v1::ListObjectsRequest* /*request*/,
                                         v1::ListObjectsResponse* response) {
  absl::MutexLock lock(&mutex_);
  return Play(list_objects, response);
}

grpc::Status ScriptedServer::GetStablePose(grpc::ServerContext* /*context*/,
                                           const v1::GetStablePoseRequest* request,
                                           v1::StablePose* response) {
  absl::MutexLock lock(&mutex_);
  if (request->name() != stable_pose.name()) return {grpc::StatusCode::NOT_FOUND, "no such pose"};
  *response = stable_pose;
  return grpc::Status::OK;
}

grpc::Status ScriptedServer::UpdateStablePose(grpc::ServerContext* /*context*/,
                                              const v1::UpdateStablePoseRequest* request,
                                              v1::StablePose* response) {
  absl::MutexLock lock(&mutex_);
  if (request->stable_pose().etag() != stable_pose.etag()) {
    return {grpc::StatusCode::ABORTED, "changed meanwhile"};
  }
  *stable_pose.mutable_grasps() = request->stable_pose().grasps();
  *response = stable_pose;
  return grpc::Status::OK;
}

grpc::Status ScriptedServer::GetCatalogStatus(grpc::ServerContext* /*context*/,
                                              const v1::GetCatalogStatusRequest* /*request*/,
                                              v1::CatalogStatus* response) {
  absl::MutexLock lock(&mutex_);
  response->set_server_version(version);
  return grpc::Status::OK;
}

grpc::Status ScriptedServer::ReportGraspOutcome(grpc::ServerContext* /*context*/,
                                                const v1::ReportGraspOutcomeRequest* request,
                                                v1::ReportGraspOutcomeResponse* /*response*/) {
  absl::MutexLock lock(&mutex_);
  return Play(report_outcome, *request);
}

}  // namespace graspdb::client
