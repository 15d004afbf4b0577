#include "recognition/models/clouds_in_memory.h"

#include <gtest/gtest.h>

#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;

class CloudsInMemoryTest : public ::testing::Test {
 protected:
  // A row of `points` points, seen from above.
  std::shared_ptr<const TaughtView> Teach(const std::string& name, int points, bool shares_frame) {
    auto cloud = std::make_shared<OrientedCloud>();
    for (int i = 0; i < points; ++i) {
      cloud->points.emplace_back(0.01F * static_cast<float>(i), 0, 0);
      cloud->normals.emplace_back(0, 0, 1);
    }
    clouds_.Add(name, std::move(cloud));
    auto view = std::make_shared<TaughtView>();
    view->name = name;
    view->shares_frame = shares_frame;
    return view;
  }

  CloudsInMemory clouds_;
};

TEST_F(CloudsInMemoryTest, AModelIsMadeOnceForAllViewsThatShareAFrame) {
  TaughtStablePose pose;
  pose.views = {Teach("a", 40, true), Teach("b", 50, true), Teach("c", 30, false)};
  const auto fused = clouds_.LoadModel(*pose.views[0], pose);
  ASSERT_THAT(fused, IsOk());
  EXPECT_EQ((*fused)->view_count, 2);
  EXPECT_EQ(*clouds_.LoadModel(*pose.views[0], pose), *fused);
  EXPECT_EQ(*clouds_.LoadModel(*pose.views[1], pose), *fused);
  const auto alone = clouds_.LoadModel(*pose.views[2], pose);
  ASSERT_THAT(alone, IsOk());
  EXPECT_EQ((*alone)->view_count, 1);
  EXPECT_EQ((*alone)->fine.cloud.points.size(), 30U);
}

TEST_F(CloudsInMemoryTest, AModelChangesWithItsViews) {
  TaughtStablePose pose;
  pose.views = {Teach("a", 40, true), Teach("b", 50, true)};
  ASSERT_THAT(clouds_.LoadModel(*pose.views[0], pose), IsOk());
  pose.views.pop_back();  // as when a view is left out
  const auto rest = clouds_.LoadModel(*pose.views[0], pose);
  ASSERT_THAT(rest, IsOk());
  EXPECT_EQ((*rest)->view_count, 1);
}

TEST_F(CloudsInMemoryTest, AnUnknownCloudIsNotFound) {
  TaughtStablePose pose;
  pose.views = {Teach("a", 40, true)};
  TaughtView unknown = *pose.views[0];
  unknown.name = "b";
  EXPECT_THAT(clouds_.Load(unknown), StatusIs(absl::StatusCode::kNotFound));
  pose.views.push_back(std::make_shared<TaughtView>(unknown));
  EXPECT_THAT(clouds_.LoadModel(*pose.views[0], pose), StatusIs(absl::StatusCode::kNotFound));
}

}  // namespace
}  // namespace graspdb::recognition
