#include "server/taught_poses.h"

#include <gmock/gmock.h>

namespace graspdb::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr char kPose[] = "objects/o/stablePoses/p";

std::shared_ptr<const recognition::TaughtView> View(const std::string& id) {
  auto view = std::make_shared<recognition::TaughtView>();
  view->stable_pose = kPose;
  view->name = std::string(kPose) + "/views/" + id;
  return view;
}

recognition::TaughtStablePose Pose(int symmetry_order) {
  recognition::TaughtStablePose pose;
  pose.name = kPose;
  pose.symmetry_order = symmetry_order;
  return pose;
}

std::vector<std::string> NamesOf(const TaughtPoses& poses) {
  std::vector<std::string> names;
  for (const auto& view : poses.at(kPose)->views) {
    names.push_back(view->name.substr(view->name.rfind('/') + 1));
  }
  return names;
}

TEST(TaughtPoses, ViewsAreKeptByName) {
  const TaughtPoses first = Changed({}, {{Pose(1)}, {}, {View("b"), View("a")}, {}});
  EXPECT_THAT(NamesOf(first), ElementsAre("a", "b"));
  const TaughtPoses second = Changed(first, {{}, {}, {View("aa")}, {}});
  EXPECT_THAT(NamesOf(second), ElementsAre("a", "aa", "b"));
  EXPECT_THAT(NamesOf(first), ElementsAre("a", "b"));
}

TEST(TaughtPoses, APoseThatIsWrittenAgainKeepsItsViews) {
  const TaughtPoses first = Changed({}, {{Pose(1)}, {}, {View("a")}, {}});
  const TaughtPoses second = Changed(first, {{Pose(4)}, {}, {}, {}});
  EXPECT_EQ(second.at(kPose)->symmetry_order, 4);
  EXPECT_THAT(NamesOf(second), ElementsAre("a"));
}

TEST(TaughtPoses, AViewIsReplacedAndRemoved) {
  const TaughtPoses first = Changed({}, {{Pose(1)}, {}, {View("a"), View("b")}, {}});
  const auto again = View("a");
  const TaughtPoses replaced = Changed(first, {{}, {}, {again}, {again->name}});
  EXPECT_THAT(NamesOf(replaced), ElementsAre("a", "b"));
  EXPECT_EQ(replaced.at(kPose)->views[0], again);
  EXPECT_THAT(NamesOf(Changed(first, {{}, {}, {}, {again->name}})), ElementsAre("b"));
}

TEST(TaughtPoses, ADeletedPoseIsGoneWithItsViews) {
  const TaughtPoses first = Changed({}, {{Pose(1)}, {}, {View("a")}, {}});
  EXPECT_THAT(Changed(first, {{}, {kPose}, {}, {View("a")->name}}), IsEmpty());
}

TEST(TaughtPoses, WhatDoesNotChangeIsShared) {
  recognition::TaughtStablePose other = Pose(1);
  other.name = "objects/q/stablePoses/p";
  const TaughtPoses first = Changed({}, {{Pose(1), other}, {}, {}, {}});
  const TaughtPoses second = Changed(first, {{}, {}, {View("a")}, {}});
  ASSERT_THAT(second, SizeIs(2));
  EXPECT_EQ(second.at(other.name), first.at(other.name));
  EXPECT_NE(second.at(kPose), first.at(kPose));
}

}  // namespace
}  // namespace graspdb::server
