// Models are in memory before the first frame needs them.
#include "server/live/model_preloader.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

#include "server/live/records.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

constexpr std::chrono::milliseconds kPoll{5};

class ModelPreloaderTest : public ServerTest {
 protected:
  // Teaches a part on a running server, stops it, and opens its catalogue.
  void Follow() {
    for (const char* part : {"wedge", "l-bracket"}) Teach(part, 3);
    server_.reset();
    auto opened = storage::Catalogue::Open(options_.database);
    ASSERT_THAT(opened, IsOk());
    catalogue_ = *std::move(opened);
    auto followed = server::LiveCatalogue::Follow(*catalogue_, {});
    ASSERT_THAT(followed, IsOk());
    live_ = *std::move(followed);
  }

  void AwaitLoaded(const server::ModelPreloader& preloader) {
    while (preloader.loaded_revision() < live_->snapshot()->revision) {
      std::this_thread::sleep_for(kPoll);
    }
  }

  // Clouds that were needed to fuse models.
  static std::int64_t CloudLoads(const server::ViewCloudCache& clouds) {
    return clouds.cloud_use().hits + clouds.cloud_use().misses;
  }

  // All models of the snapshot are needed; the misses of the cache meanwhile.
  std::int64_t MissesOfFrames(server::ViewCloudCache& clouds) {
    const std::int64_t before = clouds.model_use().misses;
    for (const auto& [name, stable_pose] : *live_->snapshot()->stable_poses) {
      for (const auto& view : stable_pose->views) {
        EXPECT_THAT(clouds.LoadModel(*view, *stable_pose), IsOk());
      }
    }
    return clouds.model_use().misses - before;
  }

  std::unique_ptr<storage::Catalogue> catalogue_;
  std::unique_ptr<server::LiveCatalogue> live_;
};

TEST_F(ModelPreloaderTest, AllModelsAreLoadedAfterAStart) {
  Follow();
  server::ViewCloudCache clouds(*catalogue_, {}, std::size_t{1} << 30U);
  const server::ModelPreloader preloader(*live_, clouds);
  AwaitLoaded(preloader);
  EXPECT_EQ(CloudLoads(clouds), 6);
  EXPECT_EQ(MissesOfFrames(clouds), 0);
}

TEST_F(ModelPreloaderTest, ModelsForPointPairsAreLoadedAsWell) {
  Follow();
  server::ViewCloudCache clouds(*catalogue_, {}, std::size_t{1} << 30U);
  const server::ModelPreloader preloader(*live_, clouds);
  AwaitLoaded(preloader);
  for (const auto& group : recognition::PairModelGroups(*live_->snapshot()->stable_poses)) {
    const auto model = clouds.LoadPairModel(group);
    ASSERT_THAT(model, IsOk());
    EXPECT_NE(*model, nullptr);
  }
  EXPECT_EQ(clouds.pair_model_use().hits, 2);
  EXPECT_EQ(clouds.pair_model_use().misses, 0);
}

TEST_F(ModelPreloaderTest, AfterAChangeOnlyTheChangedModelIsFusedAgain) {
  Follow();
  server::ViewCloudCache clouds(*catalogue_, {}, std::size_t{1} << 30U);
  const server::ModelPreloader preloader(*live_, clouds);
  AwaitLoaded(preloader);
  ASSERT_THAT(catalogue_->DeleteView(
                  live_->snapshot()->stable_poses->at(FlatPoseOf("wedge"))->views.front()->name),
              IsOk());
  AwaitLoaded(preloader);
  EXPECT_EQ(CloudLoads(clouds), 6 + 2);
  EXPECT_EQ(MissesOfFrames(clouds), 0);
}

TEST_F(ModelPreloaderTest, ModelsThatFramesUseAreNotEvicted) {
  Follow();
  std::size_t all = 0;
  {
    server::ViewCloudCache clouds(*catalogue_, {}, std::size_t{1} << 30U);
    MissesOfFrames(clouds);
    all = clouds.model_use().bytes;
  }
  // Room for two models, so that one fills the share of the preloader.
  server::ViewCloudCache clouds(*catalogue_, {}, 2 * all);
  MissesOfFrames(clouds);
  const std::int64_t loads = CloudLoads(clouds);
  const server::ModelPreloader preloader(*live_, clouds);
  AwaitLoaded(preloader);
  EXPECT_EQ(CloudLoads(clouds), loads);
  EXPECT_EQ(MissesOfFrames(clouds), 0);
}

TEST_F(ServerTest, AServerLoadsModelsWithoutFrames) {
  Teach("wedge", 3);
  Restart();
  while (Status().model_cache().byte_count() == 0) std::this_thread::sleep_for(kPoll);
  EXPECT_EQ(Status().model_cache().miss_count(), 0);
}

}  // namespace
}  // namespace graspdb::testing
