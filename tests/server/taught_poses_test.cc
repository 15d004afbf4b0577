#include "server/taught_poses.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

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

TEST(TaughtPoses, RewrittenPoseKeepsItsViews) {
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

TEST(TaughtPoses, DeletedPoseIsRemovedWithItsViews) {
  const TaughtPoses first = Changed({}, {{Pose(1)}, {}, {View("a")}, {}});
  EXPECT_THAT(Changed(first, {{}, {kPose}, {}, {View("a")->name}}), IsEmpty());
}

TEST(TaughtPoses, UnchangedPosesAreShared) {
  recognition::TaughtStablePose other = Pose(1);
  other.name = "objects/q/stablePoses/p";
  const TaughtPoses first = Changed({}, {{Pose(1), other}, {}, {}, {}});
  const TaughtPoses second = Changed(first, {{}, {}, {View("a")}, {}});
  ASSERT_THAT(second, SizeIs(2));
  EXPECT_EQ(second.at(other.name), first.at(other.name));
  EXPECT_NE(second.at(kPose), first.at(kPose));
}

// CPU seconds, the minimum of some tries, to remove all but one of `count` views of a stable
// pose.
double ForgettingTakes(int count) {
  TaughtPoseChange taught;
  for (int i = 0; i < count; ++i) taught.added_views.push_back(View(std::to_string(i)));
  const TaughtPoses poses = Changed({}, taught);
  TaughtPoseChange forgotten;
  for (int i = 1; i < count; ++i)
    forgotten.removed_views.push_back(taught.added_views[static_cast<std::size_t>(i)]->name);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const auto now = [] {
      timespec time{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
      return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    };
    const double start = now();
    EXPECT_THAT(NamesOf(Changed(poses, forgotten)), ElementsAre("0"));
    least = std::min(least, now() - start);
  }
  return least;
}

TEST(TaughtPoses, RemovingViewsTakesNLogN) {
  // 16 times as many: 16 to 22 times as long; comparing all pairs would take 256 times.
  EXPECT_LT(ForgettingTakes(32'000) / ForgettingTakes(2'000), 80);
}

}  // namespace
}  // namespace graspdb::server
