#include <gtest/gtest.h>

#include <limits>

#include "client/archive/archive_comparison.h"

namespace graspdb::client {
namespace {

v1::View SampleView() {
  v1::View view;
  view.set_name("objects/a/stablePoses/b/views/c");
  view.set_point_count(2);
  view.mutable_create_time()->set_seconds(5);
  view.mutable_object_pose()->mutable_position()->set_x(0.25);
  view.mutable_object_pose()->mutable_orientation()->set_x(0.6);
  view.mutable_object_pose()->mutable_orientation()->set_w(0.8);
  view.mutable_sensor_pose()->mutable_orientation()->set_w(1);
  view.mutable_cloud()->set_data(std::string(24, 'x'));
  return view;
}

TEST(ArchiveContent, FieldsThatAServerSetsAreNoDifference) {
  v1::Object object;
  object.set_display_name("Mug");
  v1::Object other = object;
  other.set_name("objects/mug");
  other.set_etag("r5");
  other.mutable_update_time()->set_seconds(9);
  other.mutable_delete_time()->set_seconds(8);
  other.set_release(v1::RELEASE_STATE_RELEASED);
  EXPECT_TRUE(IsSame(object, other));
  other.set_release(v1::RELEASE_STATE_DRAFT);
  EXPECT_FALSE(IsSame(object, other));
  other.clear_release();
  other.add_labels("bin-7");
  EXPECT_FALSE(IsSame(object, other));

  v1::StablePose pose;
  pose.add_grasps()->set_grasp_id("top");
  v1::StablePose counted = pose;
  counted.add_grasp_outcomes()->set_picked_count(5);
  counted.set_etag("r6");
  EXPECT_TRUE(IsSame(pose, counted));
  counted.mutable_grasps(0)->set_gripper_opening_m(0.05);
  EXPECT_FALSE(IsSame(pose, counted));
}

TEST(ArchiveContent, RoundedPosesAreTheSameAndMovedOnesAreNot) {
  const v1::View view = SampleView();
  v1::View other = view;
  other.clear_name();
  other.mutable_create_time()->set_seconds(7);
  other.mutable_object_pose()->mutable_position()->set_x(0.25 + 1e-12);
  other.mutable_object_pose()->mutable_orientation()->set_x(-0.6);  // the same rotation
  other.mutable_object_pose()->mutable_orientation()->set_w(-0.8);
  EXPECT_TRUE(IsSame(view, other));
  other.mutable_object_pose()->mutable_position()->set_x(0.25 + 1e-6);
  EXPECT_FALSE(IsSame(view, other));
  other = view;
  other.mutable_sensor_pose()->mutable_position()->set_z(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(IsSame(view, other));
}

TEST(ArchiveContent, PointsAndTheKindOfTheObjectPoseCount) {
  const v1::View view = SampleView();
  v1::View other = view;
  other.mutable_cloud()->mutable_data()->back() = 'y';
  EXPECT_FALSE(IsSame(view, other));
  EXPECT_TRUE(MayBeSame(view, other));
  other = view;
  other.set_object_pose_estimated(true);
  EXPECT_FALSE(MayBeSame(view, other));
}

}  // namespace
}  // namespace graspdb::client
