#include "client/teaching/turntable/view_taking.h"

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <memory>
#include <set>
#include <string>

#include "files/depth_message.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "tests/client/cell/agent/fake_camera.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Stores views, but fails to return them.
class UnreadableCatalogue : public v1::CatalogService::Service {
 public:
  UnreadableCatalogue() {
    grpc::ServerBuilder builder;
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }

  Client Connect() {
    return {server_->InProcessChannel({}),
            ConnectionOptions{.timeout = absl::Seconds(5), .retry = false}};
  }

  std::set<std::string> views;
  bool deletes = true;

 private:
  grpc::Status ListViews(grpc::ServerContext* /*context*/, const v1::ListViewsRequest* /*request*/,
                         v1::ListViewsResponse* /*response*/) override {
    return grpc::Status::OK;
  }
  grpc::Status UploadViews(grpc::ServerContext* /*context*/,
                           grpc::ServerReader<v1::UploadViewsRequest>* reader,
                           v1::UploadViewsResponse* response) override {
    v1::UploadViewsRequest request;
    while (reader->Read(&request)) {
      views.insert(request.parent() + "/views/" + request.view_id());
      response->set_created_count(response->created_count() + 1);
    }
    return grpc::Status::OK;
  }
  grpc::Status GetView(grpc::ServerContext* /*context*/, const v1::GetViewRequest* /*request*/,
                       v1::View* /*response*/) override {
    return {grpc::StatusCode::INTERNAL, "the disk is busy"};
  }
  grpc::Status DeleteView(grpc::ServerContext* /*context*/, const v1::DeleteViewRequest* request,
                          google::protobuf::Empty* /*response*/) override {
    if (!deletes) return {grpc::StatusCode::INTERNAL, "the disk is gone"};
    views.erase(request->name());
    return grpc::Status::OK;
  }

  std::unique_ptr<grpc::Server> server_;
};

absl::StatusOr<SensorFrame> Frame() {
  constexpr recognition::CameraIntrinsics kCameraPlace = {
      .width = 20, .height = 10, .fx = 100, .fy = 100, .cx = 9.5, .cy = 4.5};
  return SensorFrame{
      .scan = DepthMessage(std::vector<std::uint16_t>(200, 800), kCameraPlace, 0.001),
      .world_sensor = recognition::Pose::Identity()};
}

TEST(ViewTaker, NothingIsTaughtIfTheViewCannotBeReadBack) {
  UnreadableCatalogue catalogue;
  Client client = catalogue.Connect();
  FakeCamera camera(Frame);
  ViewTaker taker(camera, client, {});
  EXPECT_THAT(taker.Take("objects/cup/stablePoses/pose-1", recognition::Pose::Identity()),
              StatusIs(absl::StatusCode::kInternal, HasSubstr("the disk is busy")));
  EXPECT_THAT(catalogue.views, IsEmpty());
}

TEST(ViewTaker, AViewThatCannotBeDeletedEitherIsNamed) {
  UnreadableCatalogue catalogue;
  catalogue.deletes = false;
  Client client = catalogue.Connect();
  FakeCamera camera(Frame);
  ViewTaker taker(camera, client, {});
  const auto taken = taker.Take("objects/cup/stablePoses/pose-1", recognition::Pose::Identity());
  ASSERT_EQ(catalogue.views.size(), 1U);
  EXPECT_THAT(taken, StatusIs(absl::StatusCode::kInternal,
                              AllOf(HasSubstr("the disk is busy"), HasSubstr("the disk is gone"),
                                    HasSubstr(*catalogue.views.begin()))));
}

}  // namespace
}  // namespace graspdb::client
