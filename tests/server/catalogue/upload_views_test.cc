// Teaching: UploadViews.
#include <gmock/gmock.h>

#include "storage/base/crc32c.h"
#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

// ViewOf with a depth image.
v1::UploadViewsRequest ImageViewOf(const std::string& part, double turn_deg,
                                   const std::string& id) {
  v1::UploadViewsRequest view = ViewOf(part, turn_deg, id);
  view.mutable_view()->clear_cloud();
  *view.mutable_view()->mutable_depth_image() =
      DepthImageOf(Photograph(part, {.turn_deg = turn_deg}, 7));
  return view;
}

class UploadViewsTest : public ServerTest {
 protected:
  void SetUp() override {
    ServerTest::SetUp();
    Declare("wedge");
  }
};

// With depth images or clouds.
class EitherScanTest : public UploadViewsTest,
                       public ::testing::WithParamInterface<decltype(&ViewOf)> {
 protected:
  static v1::UploadViewsRequest View(double turn_deg, const std::string& id) {
    return GetParam()("wedge", turn_deg, id);
  }
};

std::string ScanName(const ::testing::TestParamInfo<decltype(&ViewOf)>& view) {
  return view.param == &ViewOf ? "Cloud" : "DepthImage";
}

INSTANTIATE_TEST_SUITE_P(Scans, EitherScanTest, ::testing::Values(&ViewOf, &ImageViewOf), ScanName);

TEST_P(EitherScanTest, ViewsAreCreatedOnceAndThenExist) {
  const std::vector<v1::UploadViewsRequest> views = {View(0, "a"), View(60, "b")};
  v1::UploadViewsResponse response;
  ASSERT_THAT(Upload(views, &response), IsGrpcOk());
  EXPECT_EQ(response.created_count(), 2);
  EXPECT_EQ(response.existing_count(), 0);
  EXPECT_EQ(response.catalog_revision(), Status().catalog_revision());
  const std::int64_t revision = response.catalog_revision();
  ASSERT_THAT(Upload(views, &response), IsGrpcOk());
  EXPECT_EQ(response.created_count(), 0);
  EXPECT_EQ(response.existing_count(), 2);
  EXPECT_EQ(response.catalog_revision(), revision);
  EXPECT_EQ(Status().view_count(), 2);
}

TEST_F(UploadViewsTest, AnEmptyUploadTeachesNothing) {
  v1::UploadViewsResponse response;
  ASSERT_THAT(Upload(std::vector<v1::UploadViewsRequest>(), &response), IsGrpcOk());
  EXPECT_EQ(response.created_count(), 0);
  EXPECT_EQ(response.catalog_revision(), Status().catalog_revision());
}

TEST_P(EitherScanTest, ATakenIdWithOtherContentIsAnError) {
  ASSERT_THAT(Upload(View(0, "a")), IsGrpcOk());
  ExpectError(Upload(View(90, "a")), grpc::StatusCode::ALREADY_EXISTS, "views/a");
  v1::UploadViewsRequest moved = View(0, "a");
  moved.mutable_view()->mutable_object_pose()->mutable_position()->set_x(0.01);
  ExpectError(Upload(moved), grpc::StatusCode::ALREADY_EXISTS, "views/a");
  EXPECT_EQ(Status().view_count(), 1);
}

TEST_F(UploadViewsTest, ATakenIdWithAnotherDepthUnitIsAnError) {
  v1::UploadViewsRequest view = ImageViewOf("wedge", 0, "a");
  ASSERT_THAT(Upload(view), IsGrpcOk());
  view.mutable_view()->mutable_depth_image()->set_depth_unit_m(0.00011);
  ExpectError(Upload(view), grpc::StatusCode::ALREADY_EXISTS, "views/a");
}

TEST_F(UploadViewsTest, AViewHasACloudOrADepthImage) {
  v1::UploadViewsRequest view = ImageViewOf("wedge", 0, "a");
  *view.mutable_view()->mutable_cloud() = ViewOf("wedge", 0, "a").view().cloud();
  ExpectBadField(Upload(view), "view", "both");
  view.mutable_view()->clear_cloud();
  view.mutable_view()->clear_depth_image();
  ExpectBadField(Upload(view), "view", "neither");
  view.clear_view();
  ExpectBadField(Upload(view), "view", "neither");
  EXPECT_EQ(Status().view_count(), 0);
}

TEST_F(UploadViewsTest, TheChecksumOfADepthImageIsChecked) {
  v1::UploadViewsRequest view = ImageViewOf("wedge", 0, "a");
  view.set_cloud_crc32c(storage::Crc32c(view.view().depth_image().data()) + 1);
  ExpectBadField(Upload(view), "cloud_crc32c", "view.depth_image.data");
  view.set_cloud_crc32c(view.cloud_crc32c() - 1);
  EXPECT_THAT(Upload(view), IsGrpcOk());
}

TEST_F(UploadViewsTest, TheChecksumIsChecked) {
  v1::UploadViewsRequest view = ViewOf("wedge", 0, "a");
  view.set_cloud_crc32c(storage::Crc32c(view.view().cloud().data()) + 1);
  ExpectBadField(Upload(view), "cloud_crc32c", "send the view again");
  EXPECT_EQ(Status().view_count(), 0);
  view.set_cloud_crc32c(view.cloud_crc32c() - 1);
  EXPECT_THAT(Upload(view), IsGrpcOk());
}

TEST_F(UploadViewsTest, TheStablePoseMustBeThere) {
  v1::UploadViewsRequest view = ViewOf("wedge", 0, "a");
  view.set_parent("objects/wedge/stablePoses/upright");
  ExpectError(Upload(view), grpc::StatusCode::NOT_FOUND, "objects/wedge/stablePoses/upright");
}

TEST_F(UploadViewsTest, ViewsBeforeTheFirstBadOneStay) {
  v1::UploadViewsRequest bad = ViewOf("wedge", 120, "bad");
  bad.mutable_view()->mutable_cloud()->set_point_stride(7);
  v1::UploadViewsResponse response;
  const grpc::Status status =
      Upload({ViewOf("wedge", 0, "a"), ViewOf("wedge", 60, "b"), bad, ViewOf("wedge", 180, "c")},
             &response);
  ExpectBadField(status, "view.cloud.data", "view \"bad\" of " + FlatPoseOf("wedge"));
  EXPECT_EQ(Status().view_count(), 2);
  ASSERT_THAT(Upload({ViewOf("wedge", 0, "a"), ViewOf("wedge", 180, "c")}, &response), IsGrpcOk());
  EXPECT_EQ(response.created_count(), 1);
  EXPECT_EQ(response.existing_count(), 1);
}

TEST_P(EitherScanTest, EmptyCaptureIsRejectedWithAReason) {
  v1::UploadViewsRequest view = View(0, "a");
  if (view.view().has_depth_image()) {
    *view.mutable_view()->mutable_depth_image() = DepthImageOf(PhotographEmptyTable());
  } else {
    *view.mutable_view()->mutable_cloud() = CloudOf(PhotographEmptyTable());
  }
  grpc::Status status = Upload(view);
  ExpectError(status, grpc::StatusCode::FAILED_PRECONDITION, "nothing stands on the table");
  EXPECT_EQ(ReasonOf(status), "NO_CLUSTER");
  view = View(0, "a");
  *view.mutable_region_of_interest() = BoxMessage({5, 5, 5}, {6, 6, 6});
  status = Upload(view);
  ExpectError(status, grpc::StatusCode::FAILED_PRECONDITION, "holds no measurement");
  EXPECT_EQ(ReasonOf(status), "EMPTY_REGION");
}

TEST_F(UploadViewsTest, WithoutPosesTheObjectStandsInTheFrameOfTheTable) {
  v1::UploadViewsRequest upload = ViewOf("wedge", 0, "a");
  upload.mutable_view()->clear_sensor_pose();
  upload.mutable_view()->clear_object_pose();
  ASSERT_THAT(Upload(upload), IsGrpcOk());
  v1::GetViewRequest request;
  request.set_name(FlatPoseOf("wedge") + "/views/a");
  v1::View view;
  ASSERT_THAT(Call(&Catalog::GetView, request, &view), IsGrpcOk());
  EXPECT_NEAR(view.object_pose().position().z(), 0, 1e-9);
  // The sensor stands 0.65 m away at 45 degrees.
  EXPECT_NEAR(view.sensor_pose().position().z(), 0.65 * 0.7071, 0.01);
}

TEST_P(EitherScanTest, ViewsBeforeACancellationStay) {
  grpc::ClientContext context;
  v1::UploadViewsResponse response;
  const auto stub = v1::CatalogService::NewStub(channel_);
  auto writer = stub->UploadViews(&context, &response);
  ASSERT_TRUE(writer->Write(View(0, "a")));
  while (Status().view_count() == 0) {
  }
  context.TryCancel();
  EXPECT_EQ(writer->Finish().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_EQ(Status().view_count(), 1);
  ASSERT_THAT(Upload({View(0, "a"), View(60, "b")}, &response), IsGrpcOk());
  EXPECT_EQ(response.existing_count(), 1);
  EXPECT_EQ(response.created_count(), 1);
}

TEST_F(UploadViewsTest, FarPointsAreNotTaught) {
  v1::UploadViewsRequest view = ViewOf("wedge", 0, "a");
  *view.mutable_view()->mutable_cloud() = SegmentedCloudOf("wedge", {}, 7);
  view.mutable_view()->set_segmented(true);
  std::string& data = *view.mutable_view()->mutable_cloud()->mutable_data();
  const auto count = static_cast<int>(data.size() / 12);
  const float far[3] = {1e30F, -1e30F, 1e9F};
  data.replace(0, sizeof(far), reinterpret_cast<const char*>(far), sizeof(far));
  ASSERT_THAT(Upload(view), IsGrpcOk());
  v1::GetViewRequest request;
  request.set_name(FlatPoseOf("wedge") + "/views/a");
  v1::View stored;
  ASSERT_THAT(Call(&Catalog::GetView, request, &stored), IsGrpcOk());
  EXPECT_EQ(stored.point_count(), count - 1);
}

}  // namespace
}  // namespace graspdb::testing
