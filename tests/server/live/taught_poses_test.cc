#include "server/live/taught_poses.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <set>
#include <string>

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

// CPU seconds of `work`, the minimum of some tries.
double CpuSeconds(const std::function<void()>& work) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const double start = now();
    work();
    least = std::min(least, now() - start);
  }
  return least;
}

TEST(TaughtPoses, RemovingViewsTakesNLogN) {
  TaughtPoseChange taught;
  for (int i = 0; i < 32'000; ++i) taught.added_views.push_back(View(std::to_string(i)));
  const TaughtPoses poses = Changed({}, taught);
  TaughtPoseChange forgotten;
  for (std::size_t i = 1; i < taught.added_views.size(); ++i) {
    forgotten.removed_views.push_back(taught.added_views[i]->name);
  }
  const double removing =
      CpuSeconds([&] { EXPECT_THAT(NamesOf(Changed(poses, forgotten)), ElementsAre("0")); });
  const double sorting = CpuSeconds([&] {
    const std::set<std::string> names(forgotten.removed_views.begin(),
                                      forgotten.removed_views.end());
    EXPECT_EQ(names.size(), forgotten.removed_views.size());
  });
  // 1 to 2 times as long as sorting the names; comparing all pairs would take 100 times and more.
  EXPECT_LT(removing / sorting, 15);
}

}  // namespace
}  // namespace graspdb::server
