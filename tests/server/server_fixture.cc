#include "tests/server/server_fixture.h"

#include <spdlog/spdlog.h>

#include "tests/testing/status_matchers.h"

namespace graspdb::testing {

void ServerTest::SetUp() {
  spdlog::set_level(spdlog::level::off);
  options_.database = (folder_.path() / "db").string();
  options_.listen = "127.0.0.1:0";
  Start();
}

void ServerTest::Start() {
  absl::StatusOr<std::unique_ptr<server::Server>> server = server::Server::Start(options_);
  ASSERT_THAT(server, IsOk());
  server_ = *std::move(server);
  channel_ = server_->InProcessChannel();
  backups_ = v1::BackupService::NewStub(channel_);
  catalog_ = v1::CatalogService::NewStub(channel_);
  cells_ = v1::CellService::NewStub(channel_);
  history_ = v1::ObjectHistoryService::NewStub(channel_);
  recognition_ = v1::RecognitionService::NewStub(channel_);
}

void ServerTest::Restart() {
  server_.reset();
  Start();
}

v1::CatalogStatus ServerTest::Status() {
  v1::CatalogStatus status;
  EXPECT_THAT(Call(&Catalog::GetCatalogStatus, v1::GetCatalogStatusRequest(), &status), IsGrpcOk());
  return status;
}

grpc::Status ServerTest::CreateObject(const std::string& id, v1::Object* made) {
  v1::CreateObjectRequest request;
  request.set_object_id(id);
  request.mutable_object()->set_display_name("The " + id);
  v1::Object ignored;
  return Call(&Catalog::CreateObject, request, made == nullptr ? &ignored : made);
}

void ServerTest::Declare(const std::string& part) {
  ASSERT_THAT(CreateObject(part), IsGrpcOk());
  v1::CreateStablePoseRequest request;
  request.set_parent("objects/" + part);
  request.set_stable_pose_id("flat");
  request.mutable_stable_pose()->set_symmetry_order(Part(part).symmetry_order);
  for (const v1::Grasp& grasp : Part(part).grasps) {
    *request.mutable_stable_pose()->add_grasps() = grasp;
  }
  ASSERT_THAT(Call(&Catalog::CreateStablePose, request), IsGrpcOk());
}

void ServerTest::Teach(const std::string& part, int views) {
  Declare(part);
  std::vector<v1::UploadViewsRequest> requests;
  requests.reserve(static_cast<std::size_t>(views));
  for (int i = 0; i < views; ++i) {
    requests.push_back(ViewOf(part, 360.0 * i / views, "turn-" + std::to_string(i)));
  }
  v1::UploadViewsResponse response;
  ASSERT_THAT(Upload(requests, &response), IsGrpcOk());
  ASSERT_EQ(response.created_count(), views);
}

grpc::Status ServerTest::Upload(const std::vector<v1::UploadViewsRequest>& views,
                                v1::UploadViewsResponse* response) {
  grpc::ClientContext context;
  if (!token_.empty()) context.AddMetadata("authorization", "Bearer " + token_);
  auto writer = catalog_->UploadViews(&context, response);
  for (const v1::UploadViewsRequest& view : views) {
    if (!writer->Write(view)) break;
  }
  writer->WritesDone();
  return writer->Finish();
}

grpc::Status ServerTest::Upload(const v1::UploadViewsRequest& view) {
  v1::UploadViewsResponse ignored;
  return Upload({view}, &ignored);
}

v1::RecognizeResponse ServerTest::Answer(const v1::RecognizeRequest& request) {
  v1::RecognizeResponse response;
  EXPECT_THAT(Call(&Recognition::Recognize, request, &response), IsGrpcOk());
  return response;
}

std::string FlatPoseOf(const std::string& part) { return "objects/" + part + "/stablePoses/flat"; }

v1::UploadViewsRequest ViewOf(const std::string& part, double turn_deg, const std::string& id) {
  const Frame frame = Photograph(part, {.turn_deg = turn_deg}, 7);
  v1::UploadViewsRequest request;
  request.set_parent(FlatPoseOf(part));
  request.set_view_id(id);
  *request.mutable_view()->mutable_cloud() = CloudOf(frame);
  *request.mutable_view()->mutable_sensor_pose() = PoseMessage(frame.world_sensor);
  *request.mutable_view()->mutable_object_pose() = PoseMessage(frame.world_object);
  return request;
}

v1::RecognizeRequest RequestOf(const Frame& frame) {
  v1::RecognizeRequest request;
  *request.mutable_cloud() = CloudOf(frame);
  *request.mutable_sensor_pose() = PoseMessage(frame.world_sensor);
  request.set_omit_timings(true);
  return request;
}

}  // namespace graspdb::testing
