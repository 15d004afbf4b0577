#include "client/cell/blackbox/black_box.h"

#include <gmock/gmock.h>

#include <thread>
#include <vector>

#include "client/cell/blackbox/bundle_files.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;

v1::Bundle BundleOf(int job) {
  v1::Bundle out;
  out.set_job(job);
  out.mutable_request()->mutable_cloud()->set_data(std::string(2000, 'x'));
  out.mutable_response()->set_status(v1::NO_CLUSTER);
  return out;
}

class BlackBoxTest : public ::testing::Test {
 protected:
  std::unique_ptr<BlackBox> Open(std::size_t max_waiting = 1000) const {
    auto box = BlackBox::Open(
        {.ring = {.folder = folder_.path(), .min_free_bytes = 0}, .max_waiting = max_waiting});
    EXPECT_THAT(box, IsOk());
    return *std::move(box);
  }

  std::vector<int> Jobs() const {
    std::vector<int> out;
    const auto paths = ListBundles({folder_.path().string()});
    if (!paths.ok()) return out;
    for (const auto& path : *paths) out.push_back(ReadBundle(path)->job());
    return out;
  }

  files::TemporaryFolder folder_;
};

TEST_F(BlackBoxTest, KeepsBundlesInOrder) {
  const auto box = Open();
  for (int job = 1; job <= 3; ++job) EXPECT_TRUE(box->Keep(BundleOf(job)));
  box->Flush();
  EXPECT_THAT(Jobs(), ::testing::ElementsAre(1, 2, 3));
  EXPECT_EQ(box->counts().kept, 3);
}

TEST_F(BlackBoxTest, TheDestructorWritesQueuedBundles) {
  auto box = Open();
  for (int job = 1; job <= 50; ++job) EXPECT_TRUE(box->Keep(BundleOf(job)));
  box.reset();
  EXPECT_EQ(Jobs().size(), 50U);
}

TEST_F(BlackBoxTest, BundlesBeyondTheQueueAreDroppedAndCounted) {
  const auto box = Open(0);
  EXPECT_FALSE(box->Keep(BundleOf(1)));
  box->Flush();
  EXPECT_EQ(box->counts().dropped, 1);
  EXPECT_EQ(box->counts().kept, 0);
}

TEST_F(BlackBoxTest, ConcurrentBundlesAreAllCounted) {
  const auto box = Open(4);
  std::vector<std::thread> robots;
  robots.reserve(4);
  for (int robot = 0; robot < 4; ++robot) {
    robots.emplace_back([&box] {
      for (int i = 0; i < 50; ++i) box->Keep(BundleOf(i));
    });
  }
  for (std::thread& robot : robots) robot.join();
  box->Flush();
  const BlackBoxCounts counts = box->counts();
  EXPECT_EQ(counts.kept + counts.dropped, 200);
  EXPECT_EQ(counts.failed, 0);
  EXPECT_EQ(Jobs().size(), static_cast<std::size_t>(counts.kept));
}

TEST_F(BlackBoxTest, WriteErrorsAreCounted) {
  auto box =
      BlackBox::Open({.ring = {.folder = folder_.path(), .byte_limit = 100, .min_free_bytes = 0}});
  ASSERT_THAT(box, IsOk());
  EXPECT_TRUE((*box)->Keep(BundleOf(1)));
  (*box)->Flush();
  EXPECT_EQ((*box)->counts().failed, 1);
}

TEST(IsTroubled, ErrorsAndLowScores) {
  v1::Bundle bundle;
  bundle.mutable_error()->set_code(14);
  EXPECT_TRUE(IsTroubled(bundle, 0));
  bundle.mutable_response()->set_status(v1::UNKNOWN_OBJECT);
  EXPECT_TRUE(IsTroubled(bundle, 0));
  bundle.mutable_response()->set_status(v1::OK);
  v1::Detection& detection = *bundle.mutable_response()->add_detections();
  detection.set_status(v1::OK);
  detection.set_score(0.7);
  EXPECT_FALSE(IsTroubled(bundle, 0.7));
  EXPECT_TRUE(IsTroubled(bundle, 0.71));
  detection.set_status(v1::AMBIGUOUS);
  EXPECT_TRUE(IsTroubled(bundle, 0.7));
}

}  // namespace
}  // namespace graspdb::client
