#include "client/teaching/turntable/view_taking.h"

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "files/messages/scan_message.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "tests/client/cell/agent/fake_camera.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Stores the uploads of views by name, but fails to return views.
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

  std::map<std::string, v1::View> views;
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
      views.emplace(request.parent() + "/views/" + request.view_id(), request.view());
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
      .scan = files::DepthMessage(std::vector<std::uint16_t>(200, 800), kCameraPlace, 0.001),
      .world_sensor = recognition::Pose::Identity()};
}

// The view that two frames of these scans upload.
v1::View Uploaded(const std::vector<files::ScanMessage>& scans) {
  UnreadableCatalogue catalogue;
  catalogue.deletes = false;
  Client client = catalogue.Connect();
  std::size_t next = 0;
  FakeCamera camera([&]() -> absl::StatusOr<SensorFrame> {
    return SensorFrame{.scan = scans.at(next++), .world_sensor = recognition::Pose::Identity()};
  });
  ViewTaker taker(camera, client, {.frames = static_cast<int>(scans.size())});
  EXPECT_FALSE(taker.Take("objects/cup/stablePoses/pose-1", recognition::Pose::Identity()).ok());
  EXPECT_EQ(catalogue.views.size(), 1U);
  return catalogue.views.empty() ? v1::View() : catalogue.views.begin()->second;
}

TEST(ViewTaker, TheMeanOfDepthImagesIsUploadedAsAFinerDepthImage) {
  constexpr recognition::CameraIntrinsics kTwoPixels = {
      .width = 2, .height = 1, .fx = 100, .fy = 100, .cx = 0.5, .cy = 0};
  const v1::View view = Uploaded({files::DepthMessage({800, 2000}, kTwoPixels, 0.001),
                                  files::DepthMessage({801, 0}, kTwoPixels, 0.001)});
  EXPECT_FALSE(view.has_cloud());
  EXPECT_EQ(files::FromMessage(view.depth_image().intrinsics()), kTwoPixels);
  const auto points = files::PointsFromMessage(view.depth_image());
  ASSERT_THAT(points, IsOk());
  EXPECT_NEAR((*points)[0].z(), 0.8005, 16e-6);
  EXPECT_NEAR((*points)[1].z(), 2, 16e-6);
}

TEST(ViewTaker, CloudsAreUploadedAsClouds) {
  const v1::PointCloud cloud = files::CloudMessage({{0, 0, 0.5F}, {0.1F, 0, 0.5F}}, 2);
  const v1::View view = Uploaded({cloud, cloud});
  EXPECT_FALSE(view.has_depth_image());
  EXPECT_EQ(view.cloud().data(), cloud.data());
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
                                    HasSubstr(catalogue.views.begin()->first))));
}

}  // namespace
}  // namespace graspdb::client
