// The view that is stored of an upload.
#include "server/catalogue/teacher.h"

#include <gmock/gmock.h>

#include "server/live/records.h"
#include "server/requests/convert.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

absl::StatusOr<storage::NewView> Made(const v1::UploadViewsRequest& request) {
  return server::MakeView(request, {}, {}, [] { return false; });
}

// The same frame as a cloud and as a depth image.
class EqualViewsTest : public ::testing::Test {
 protected:
  EqualViewsTest() {
    const Frame frame = Photograph("wedge", {.x = 0.02, .turn_deg = 33}, 5);
    *cloud_.mutable_view()->mutable_cloud() = CloudOf(frame);
    *image_.mutable_view()->mutable_depth_image() = DepthImageOf(frame);
    for (v1::UploadViewsRequest* request : {&cloud_, &image_}) {
      *request->mutable_view()->mutable_sensor_pose() = PoseMessage(frame.world_sensor);
      *request->mutable_view()->mutable_object_pose() = PoseMessage(frame.world_object);
    }
  }

  // Poses, descriptors and packed points, bit for bit.
  void ExpectEqualViews() {
    auto of_cloud = Made(cloud_);
    auto of_image = Made(image_);
    ASSERT_THAT(of_cloud, IsOk());
    ASSERT_THAT(of_image, IsOk());
    EXPECT_GT(of_image->record.point_count(), 100);
    EXPECT_EQ(of_image->packed_cloud, of_cloud->packed_cloud);
    EXPECT_NE(server::UploadDigest(image_), server::UploadDigest(cloud_));
    EXPECT_EQ(of_image->record.SerializeAsString(), of_cloud->record.SerializeAsString());
  }

  v1::UploadViewsRequest cloud_;
  v1::UploadViewsRequest image_;
};

TEST_F(EqualViewsTest, ADepthImageIsStoredAsItsCloud) { ExpectEqualViews(); }

TEST_F(EqualViewsTest, AlsoWithoutPoses) {
  for (v1::UploadViewsRequest* request : {&cloud_, &image_}) {
    request->mutable_view()->clear_sensor_pose();
    request->mutable_view()->clear_object_pose();
  }
  ExpectEqualViews();
}

TEST_F(EqualViewsTest, AlsoOfTheObjectAlone) {
  for (v1::UploadViewsRequest* request : {&cloud_, &image_}) {
    request->mutable_view()->set_segmented(true);
    *request->mutable_region_of_interest() = BoxMessage({-0.1, -0.1, 0.01}, {0.1, 0.1, 0.2});
  }
  ExpectEqualViews();
}

// The object's pose is stored, and makes a shorter way to the rest.
TEST_F(EqualViewsTest, TheObjectAloneIsStoredTheSameWithAndWithoutItsPose) {
  cloud_.mutable_view()->set_segmented(true);
  *cloud_.mutable_region_of_interest() = BoxMessage({-0.1, -0.1, 0.01}, {0.1, 0.1, 0.2});
  auto with_pose = Made(cloud_);
  ASSERT_THAT(with_pose, IsOk());
  cloud_.mutable_view()->clear_object_pose();
  auto without_pose = Made(cloud_);
  ASSERT_THAT(without_pose, IsOk());
  EXPECT_EQ(with_pose->packed_cloud, without_pose->packed_cloud);
  for (storage::ViewRecord* record : {&with_pose->record, &without_pose->record}) {
    record->clear_object_pose();
    record->clear_object_pose_given();
  }
  EXPECT_EQ(with_pose->record.SerializeAsString(), without_pose->record.SerializeAsString());
}

// What a server stored is what another one stores: packed points and poses, to the last bit.
TEST_F(EqualViewsTest, AStoredViewIsStoredAsItIs) {
  for (const bool estimated : {false, true}) {
    if (estimated) cloud_.mutable_view()->clear_object_pose();
    auto stored = Made(cloud_);
    ASSERT_THAT(stored, IsOk());
    EXPECT_EQ(stored->record.object_pose_given(), !estimated);
    v1::UploadViewsRequest again;
    const auto points = server::PointsFromPacked(stored->packed_cloud);
    ASSERT_THAT(points, IsOk());
    *again.mutable_view()->mutable_cloud() = PackedCloud(*points);
    *again.mutable_view()->mutable_sensor_pose() = stored->record.sensor_pose();
    *again.mutable_view()->mutable_object_pose() = stored->record.object_pose();
    again.mutable_view()->set_object_pose_estimated(estimated);
    again.mutable_view()->set_segmented(true);
    auto copy = Made(again);
    ASSERT_THAT(copy, IsOk());
    EXPECT_EQ(copy->packed_cloud, stored->packed_cloud);
    stored->record.clear_content_digest();
    copy->record.clear_content_digest();
    EXPECT_EQ(copy->record.SerializeAsString(), stored->record.SerializeAsString());
  }
}

// So that it can be computed again, to the last bit.
TEST_F(EqualViewsTest, TheDescriptorIsThatOfThePackedPoints) {
  for (const v1::UploadViewsRequest* request : {&cloud_, &image_}) {
    const auto made = Made(*request);
    ASSERT_THAT(made, IsOk());
    const auto sensor = server::PoseFromProto(made->record.sensor_pose(), "sensor_pose");
    ASSERT_THAT(sensor, IsOk());
    const auto cloud = server::CloudFromPacked(made->packed_cloud, *sensor, {});
    ASSERT_THAT(cloud, IsOk());
    const auto descriptor = server::MakeDescriptorRecord(*cloud, *sensor, {});
    ASSERT_THAT(descriptor, IsOk());
    ASSERT_EQ(made->record.descriptors_size(), 1);
    EXPECT_EQ(made->record.descriptors(0).SerializeAsString(), descriptor->SerializeAsString());
  }
}

TEST_F(EqualViewsTest, TheTableIsNotPartOfAnObject) {
  image_.mutable_view()->set_segmented(true);
  const absl::Status far = Made(image_).status();
  EXPECT_THAT(far,
              StatusIs(absl::StatusCode::kInvalidArgument,
                       ::testing::HasSubstr("view.depth_image: shows an object larger than 1 m")));
}

TEST_F(EqualViewsTest, ACancelledUploadIsNotMade) {
  EXPECT_THAT(server::MakeView(image_, {}, {}, [] { return true; }),
              StatusIs(absl::StatusCode::kCancelled));
}

}  // namespace
}  // namespace graspdb::testing
