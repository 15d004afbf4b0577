#include "tests/fuzz/fuzz_server.h"

#include <spdlog/spdlog.h>

#include <filesystem>

#include "tests/fuzz/requirement.h"
#include "tests/fuzz/sample_frames.h"

namespace graspdb::fuzz {

FuzzServer::FuzzServer() {
  spdlog::set_level(spdlog::level::off);
  Restart();
}

void FuzzServer::Restart() {
  server_.reset();
  server::ServerOptions options;
  options.database = database();
  options.listen = "127.0.0.1:0";
  options.workers = 1;
  options.max_points = kMaxPoints;
  options.cache_mib = 16;
  auto server = server::Server::Start(options);
  if (!server.ok()) std::fprintf(stderr, "%s\n", server.status().ToString().c_str());
  Require(server.ok(), "the server starts");
  server_ = *std::move(server);
  const auto channel = server_->InProcessChannel();
  catalog_ = v1::CatalogService::NewStub(channel);
  cells_ = v1::CellService::NewStub(channel);
  recognition_ = v1::RecognitionService::NewStub(channel);
  uploads_ = v1::UploadService::NewStub(channel);
  history_ = v1::ObjectHistoryService::NewStub(channel);
}

void FuzzServer::StartAnew() {
  server_.reset();
  std::filesystem::remove_all(database());
  Restart();
}

void FuzzServer::Declare(const std::string& object_id) {
  grpc::ClientContext object_call;
  v1::CreateObjectRequest object;
  object.set_object_id(object_id);
  v1::Object made;
  Require(catalog_->CreateObject(&object_call, object, &made).ok(), "an object is made");
  v1::CreateStablePoseRequest pose;
  pose.set_parent("objects/" + object_id);
  pose.set_stable_pose_id("flat");
  for (const char* id : {"top", "side"}) {
    v1::Grasp& grasp = *pose.mutable_stable_pose()->add_grasps();
    grasp.set_grasp_id(id);
    grasp.mutable_tcp_pose()->mutable_position()->set_z(0.05);
    grasp.mutable_tcp_pose()->mutable_orientation()->set_x(1);
    grasp.set_gripper_opening_m(0.06);
  }
  grpc::ClientContext pose_call;
  v1::StablePose made_pose;
  Require(catalog_->CreateStablePose(&pose_call, pose, &made_pose).ok(), "a stable pose is made");
}

grpc::Status FuzzServer::Upload(
    const google::protobuf::RepeatedPtrField<v1::UploadViewsRequest>& views,
    v1::UploadViewsResponse* response) {
  grpc::ClientContext context;
  const auto writer = catalog_->UploadViews(&context, response);
  for (const v1::UploadViewsRequest& view : views) {
    if (!writer->Write(view)) break;
  }
  writer->WritesDone();
  return writer->Finish();
}

void FuzzServer::TeachParts() {
  constexpr int kViews = 4;
  google::protobuf::RepeatedPtrField<v1::UploadViewsRequest> views;
  for (const char* part : {kFusedPart, kLoosePart}) {
    Declare(part);
    for (int i = 0; i < kViews; ++i) {
      *views.Add() = SegmentedView(part, 90.0 * i, std::to_string(i), part == kFusedPart);
    }
  }
  v1::UploadViewsResponse response;
  const grpc::Status status = Upload(views, &response);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.error_message().c_str());
  Require(status.ok(), "the parts can be taught");
}

}  // namespace graspdb::fuzz
