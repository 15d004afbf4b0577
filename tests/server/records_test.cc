#include "server/records.h"

#include <gmock/gmock.h>

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

}  // namespace
}  // namespace graspdb::server
