#include "server/live/view_cloud_cache.h"

#include <gmock/gmock.h>

#include "server/live/records.h"
#include "storage/records/packed_cloud.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using testing::IsOk;
using testing::StatusIs;
using SharedView = std::shared_ptr<const recognition::TaughtView>;

constexpr std::size_t kAmple = 1U << 20;

class ViewCloudCacheTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = storage::Catalogue::Open((folder_.path() / "db").string());
    ASSERT_THAT(opened, IsOk());
    catalogue_ = *std::move(opened);
    v1::Object object;
    object.set_name("objects/o");
    ASSERT_THAT(catalogue_->CreateObject(object), IsOk());
    v1::StablePose pose;
    pose.set_name("objects/o/stablePoses/p");
    ASSERT_THAT(catalogue_->CreateStablePose(pose), IsOk());
  }

  static std::string NameOf(const std::string& id) { return "objects/o/stablePoses/p/views/" + id; }

  // Stores a view of `points` points, all in voxels of their own.
  SharedView Put(const std::string& id, const std::string& digest, int points,
                 bool object_pose_given = true) {
    storage::NewView view;
    view.record.set_object_pose_given(object_pose_given);
    view.record.set_name(NameOf(id));
    view.record.set_content_digest(digest);
    view.record.mutable_object_pose()->mutable_orientation()->set_w(1);
    view.record.mutable_sensor_pose()->mutable_orientation()->set_w(1);
    std::vector<storage::CloudPoint> cloud;
    cloud.reserve(static_cast<std::size_t>(points));
    for (int i = 0; i < points; ++i) cloud.push_back({0.0101F * static_cast<float>(i), 0, 0.6F});
    view.packed_cloud = storage::PackCloud(cloud).value();
    EXPECT_THAT(catalogue_->PutView(view), IsOk());
    return ViewFromRecord(view.record).value();
  }

  void Delete(const std::string& id) { EXPECT_THAT(catalogue_->DeleteView(NameOf(id)), IsOk()); }

  static std::size_t Bytes(const ViewCloudCache& cache) {
    return cache.cloud_use().bytes + cache.model_use().bytes;
  }

  // Bytes of the cache for one such cloud.
  std::size_t BytesOf(const SharedView& view) {
    ViewCloudCache cache(*catalogue_, {}, kAmple);
    EXPECT_THAT(cache.Load(*view), IsOk());
    return Bytes(cache);
  }

  const files::TemporaryFolder folder_;
  std::unique_ptr<storage::Catalogue> catalogue_;
};

TEST_F(ViewCloudCacheTest, ACloudIsReadOnce) {
  const SharedView view = Put("a", "1", 20);
  ViewCloudCache cache(*catalogue_, {}, kAmple);
  const auto first = cache.Load(*view);
  ASSERT_THAT(first, IsOk());
  EXPECT_EQ((*first)->points.size(), 20U);
  EXPECT_EQ((*first)->normals.size(), 20U);
  EXPECT_GE(Bytes(cache), std::size_t{20} * 2 * sizeof(Eigen::Vector3f));
  EXPECT_EQ(*cache.Load(*view), *first);
}

TEST_F(ViewCloudCacheTest, ACloudTakesNoMoreMemoryThanItsPoints) {
  recognition::DescriptorParameters coarse;
  coarse.voxel_size_m = 0.05;
  const SharedView view = Put("a", "1", 20);
  ViewCloudCache cache(*catalogue_, coarse, kAmple);
  const auto cloud = cache.Load(*view);
  ASSERT_THAT(cloud, IsOk());
  ASSERT_LT((*cloud)->points.size(), 20U);
  EXPECT_EQ((*cloud)->points.capacity(), (*cloud)->points.size());
  EXPECT_EQ((*cloud)->normals.capacity(), (*cloud)->normals.size());
}

TEST_F(ViewCloudCacheTest, LeastRecentlyUsedIsEvictedFirst) {
  const SharedView a = Put("a", "1", 50);
  const SharedView b = Put("b", "1", 50);
  const SharedView c = Put("c", "1", 50);
  ViewCloudCache cache(*catalogue_, {}, ViewCloudCache::kCloudShare * (2 * BytesOf(a) + 10));
  for (const SharedView& view : {a, b, a, c}) ASSERT_THAT(cache.Load(*view), IsOk());
  EXPECT_EQ(Bytes(cache), 2 * BytesOf(a));
  for (const char* id : {"a", "b", "c"}) Delete(id);
  EXPECT_THAT(cache.Load(*a), IsOk()) << "was used again and should still be cached";
  EXPECT_THAT(cache.Load(*c), IsOk()) << "was added last and should still be cached";
  EXPECT_THAT(cache.Load(*b), StatusIs(absl::StatusCode::kNotFound));
}

TEST_F(ViewCloudCacheTest, TheBudgetIsKept) {
  std::vector<SharedView> views;
  views.reserve(20);
  for (int i = 0; i < 20; ++i) views.push_back(Put("v" + std::to_string(i), "1", 20 + 10 * i));
  const std::size_t budget = BytesOf(views.back()) + 100;
  ViewCloudCache cache(*catalogue_, {}, ViewCloudCache::kCloudShare * budget);
  for (const SharedView& view : views) {
    ASSERT_THAT(cache.Load(*view), IsOk());
    EXPECT_LE(Bytes(cache), budget);
    EXPECT_GT(Bytes(cache), 0U);
  }
}

TEST_F(ViewCloudCacheTest, HitsAndMissesAreCounted) {
  const SharedView a = Put("a", "1", 20);
  ViewCloudCache cache(*catalogue_, {}, kAmple);
  for (int i = 0; i < 3; ++i) ASSERT_THAT(cache.Load(*a), IsOk());
  EXPECT_EQ(cache.cloud_use().misses, 1);
  EXPECT_EQ(cache.cloud_use().hits, 2);
  EXPECT_EQ(cache.cloud_use().byte_budget, kAmple / ViewCloudCache::kCloudShare);
  EXPECT_EQ(cache.model_use().hits + cache.model_use().misses, 0);
}

TEST_F(ViewCloudCacheTest, CloudLargerThanTheBudgetIsLoadedButNotCached) {
  const SharedView view = Put("a", "1", 50);
  ViewCloudCache cache(*catalogue_, {}, 100);
  const auto cloud = cache.Load(*view);
  ASSERT_THAT(cloud, IsOk());
  EXPECT_EQ((*cloud)->points.size(), 50U);
  EXPECT_EQ(Bytes(cache), 0U);
}

TEST_F(ViewCloudCacheTest, ADeletedViewIsNotFound) {
  const SharedView view = Put("a", "1", 20);
  Delete("a");
  ViewCloudCache cache(*catalogue_, {}, kAmple);
  EXPECT_THAT(cache.Load(*view), StatusIs(absl::StatusCode::kNotFound));
  EXPECT_EQ(Bytes(cache), 0U);
}

TEST_F(ViewCloudCacheTest, ReusedNameHasItsNewCloud) {
  const SharedView old_view = Put("a", "1", 20);
  ViewCloudCache cache(*catalogue_, {}, kAmple);
  ASSERT_THAT(cache.Load(*old_view), IsOk());
  Delete("a");
  const SharedView new_view = Put("a", "2", 30);
  const auto cloud = cache.Load(*new_view);
  ASSERT_THAT(cloud, IsOk());
  EXPECT_EQ((*cloud)->points.size(), 30U);
  ViewCloudCache cold(*catalogue_, {}, kAmple);
  EXPECT_THAT(cold.Load(*old_view), StatusIs(absl::StatusCode::kNotFound));
}

TEST_F(ViewCloudCacheTest, ModelIsFusedFromTheViewsThatShareAFrame) {
  recognition::TaughtStablePose pose;
  pose.views = {Put("a", "1", 40), Put("b", "1", 50), Put("c", "1", 30, false)};
  ViewCloudCache cache(*catalogue_, {}, kAmple);
  const auto fused = cache.LoadModel(*pose.views[0], pose);
  ASSERT_THAT(fused, IsOk());
  EXPECT_EQ((*fused)->view_count, 2);
  EXPECT_EQ((*fused)->fine.cloud.points.size(), 50U);
  EXPECT_EQ(*cache.LoadModel(*pose.views[1], pose), *fused);
  const auto alone = cache.LoadModel(*pose.views[2], pose);
  ASSERT_THAT(alone, IsOk());
  EXPECT_EQ((*alone)->view_count, 1);
  EXPECT_EQ((*alone)->fine.cloud.points.size(), 30U);
}

TEST_F(ViewCloudCacheTest, AModelFollowsItsViews) {
  recognition::TaughtStablePose pose;
  pose.views = {Put("a", "1", 40)};
  ViewCloudCache cache(*catalogue_, {}, kAmple);
  ASSERT_THAT(cache.LoadModel(*pose.views[0], pose), IsOk());
  pose.views.push_back(Put("b", "1", 60));
  const auto model = cache.LoadModel(*pose.views[0], pose);
  ASSERT_THAT(model, IsOk());
  EXPECT_EQ((*model)->fine.cloud.points.size(), 60U);
}

}  // namespace
}  // namespace graspdb::server
