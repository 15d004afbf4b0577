#include "server/live/records.h"

#include <gmock/gmock.h>

#include <utility>
#include <vector>

#include "recognition/segmentation/segmentation.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

storage::ViewRecord GoodRecord() {
  storage::ViewRecord record;
  record.set_name("objects/mug/stablePoses/upright/views/a");
  record.set_content_digest("digest");
  record.mutable_object_pose()->mutable_position()->set_x(0.25);
  record.mutable_object_pose()->mutable_orientation()->set_w(1);
  record.mutable_sensor_pose()->mutable_orientation()->set_z(1);
  return record;
}

TEST(Records, ViewHasTheNamesOfItsParents) {
  const auto view = ViewFromRecord(GoodRecord());
  ASSERT_THAT(view, IsOk());
  EXPECT_EQ((*view)->object, "objects/mug");
  EXPECT_EQ((*view)->stable_pose, "objects/mug/stablePoses/upright");
  EXPECT_EQ((*view)->content, "digest");
  EXPECT_EQ((*view)->world_object.translation().x(), 0.25);
  EXPECT_NEAR((*view)->world_sensor.linear()(0, 0), -1, 1e-12);
}

TEST(Records, InvalidRecordIsDataLoss) {
  storage::ViewRecord record = GoodRecord();
  record.clear_sensor_pose();
  EXPECT_THAT(ViewFromRecord(record),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("restore a backup")));
  record = GoodRecord();
  record.set_name("objects/mug");
  EXPECT_THAT(ViewFromRecord(record), StatusIs(absl::StatusCode::kDataLoss));
}

TEST(Records, OnlyADescriptorOfTheSameParametersIsFound) {
  recognition::DescriptorParameters parameters;
  recognition::DescriptorParameters coarser = parameters;
  coarser.voxel_size_m = 0.004;
  storage::ViewRecord record = GoodRecord();
  EXPECT_EQ(FindDescriptor(record, parameters), nullptr);
  storage::DescriptorRecord* descriptor = record.add_descriptors();
  descriptor->set_parameters(coarser.Fingerprint());
  descriptor->mutable_bins()->Resize(recognition::DescriptorSize(coarser.kind), 0);
  EXPECT_EQ(FindDescriptor(record, parameters), nullptr);
  EXPECT_EQ(FindDescriptor(record, coarser), descriptor);
  descriptor->mutable_bins()->RemoveLast();
  EXPECT_EQ(FindDescriptor(record, coarser), nullptr);
}

// To the last bit: a descriptor that is computed again is that which was stored.
TEST(Records, PackedAndUnpackedCloudsAreTheSameInTheWorldFrame) {
  std::vector<storage::CloudPoint> measured;
  measured.reserve(900);
  for (int i = 0; i < 900; ++i) {
    const auto x = static_cast<float>(i % 30);
    const int row = i / 30;
    const auto y = static_cast<float>(row);
    measured.push_back({0.0013F * x, 0.0017F * y, 0.6F + 0.00003F * x * y});
  }
  std::vector<storage::CloudPoint> unpacked;
  const auto packed = storage::PackCloud(measured, &unpacked);
  ASSERT_THAT(packed, IsOk());
  recognition::Pose sensor(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, 3).normalized()));
  sensor.translation() = Eigen::Vector3d(0.1, -0.2, 0.3);
  recognition::Points moved;
  moved.reserve(unpacked.size());
  for (const storage::CloudPoint& p : unpacked) {
    const Eigen::Vector3d point = Eigen::Vector3f(p[0], p[1], p[2]).cast<double>();
    moved.emplace_back((sensor * point).cast<float>());
  }
  const auto expected = recognition::PrepareCloud(moved, sensor.translation(), {});
  EXPECT_GT(expected.points.size(), 100U);
  const auto from_packed = CloudFromPacked(*packed, sensor, {});
  ASSERT_THAT(from_packed, IsOk());
  EXPECT_EQ(from_packed->points, expected.points);
  EXPECT_EQ(from_packed->normals, expected.normals);
  const auto from_unpacked = CloudFromUnpacked(std::move(unpacked), sensor, {});
  EXPECT_EQ(from_unpacked.points, expected.points);
  EXPECT_EQ(from_unpacked.normals, expected.normals);
}

}  // namespace
}  // namespace graspdb::server
