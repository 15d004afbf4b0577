// The catalogue in memory: it follows every change, and describes views again when the
// server's parameters change.
#include "server/live_catalogue.h"

#include <gmock/gmock.h>

#include "server/records.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;

recognition::DescriptorParameters ParametersOf(const server::ServerOptions& options) {
  recognition::DescriptorParameters out;
  out.kind = *recognition::DescriptorFromName(options.descriptor);
  out.voxel_size_m = options.voxel_size_m;
  out.normal_radius_m = options.normal_radius_m;
  return out;
}

class LiveCatalogueTest : public ServerTest {
 protected:
  // Bins of the taught view's descriptor with the server's parameters, while the server
  // is down; empty without one.
  std::vector<float> StoredBins() {
    server_.reset();
    const auto catalogue = storage::Catalogue::Open(options_.database);
    EXPECT_THAT(catalogue, IsOk());
    const auto view = (*catalogue)->GetView(FlatPoseOf("wedge") + "/views/turn-0");
    EXPECT_THAT(view, IsOk());
    EXPECT_EQ(view->descriptors_size(), 1);
    const storage::DescriptorRecord* found = server::FindDescriptor(*view, ParametersOf(options_));
    if (found == nullptr) return {};
    return {found->bins().begin(), found->bins().end()};
  }

  const v1::RecognizeRequest request_ = RequestOf(Photograph("wedge", {.turn_deg = 8}, 3));
};

TEST_F(LiveCatalogueTest, ARestartWithTheSameParametersChangesNothing) {
  Teach("wedge", 2);
  const std::int64_t revision = Status().catalog_revision();
  Restart();
  EXPECT_EQ(Status().catalog_revision(), revision);
  EXPECT_EQ(Answer(request_).status(), v1::OK);
}

TEST_F(LiveCatalogueTest, ARestartWithAnotherVoxelSizeDescribesViewsAgain) {
  Teach("wedge", 2);
  const std::vector<float> fine = StoredBins();
  ASSERT_EQ(fine.size(), 288U);
  options_.voxel_size_m = 0.005;
  EXPECT_THAT(StoredBins(), ::testing::IsEmpty());
  Start();
  EXPECT_EQ(Answer(request_).status(), v1::OK);
  const std::vector<float> coarse = StoredBins();
  ASSERT_EQ(coarse.size(), 288U);
  EXPECT_NE(coarse, fine);
  options_.voxel_size_m = 0.003;
  Start();
  EXPECT_EQ(StoredBins(), fine);
}

TEST_F(LiveCatalogueTest, ARestartWithAnotherDescriptorDescribesViewsAgain) {
  Teach("wedge", 2);
  for (const char* descriptor : {"vfh263", "vfh308"}) {
    options_.descriptor = descriptor;
    Restart();
    EXPECT_EQ(Status().descriptor_name(), descriptor);
    EXPECT_EQ(Answer(request_).status(), v1::OK);
    EXPECT_EQ(StoredBins().size(), descriptor == std::string("vfh263") ? 263U : 308U);
    Start();
  }
}

TEST_F(LiveCatalogueTest, ParametersThatAViewCannotBeDescribedWithAreRefused) {
  Teach("wedge", 2);
  server_.reset();
  options_.voxel_size_m = 0.1;
  const auto started = server::Server::Start(options_);
  EXPECT_THAT(started, StatusIs(absl::StatusCode::kFailedPrecondition,
                                HasSubstr(FlatPoseOf("wedge") + "/views/turn-0")));
  EXPECT_THAT(std::string(started.status().message()), HasSubstr("--voxel-size"));
  options_.voxel_size_m = 0.003;
  Start();
  EXPECT_EQ(Answer(request_).status(), v1::OK);
}

TEST_F(LiveCatalogueTest, ASnapshotStaysWhatItWasWhileTheCatalogueChanges) {
  Teach("wedge", 3);
  server_.reset();
  const auto catalogue = storage::Catalogue::Open(options_.database);
  ASSERT_THAT(catalogue, IsOk());
  const auto live = server::LiveCatalogue::Follow(**catalogue, ParametersOf(options_));
  ASSERT_THAT(live, IsOk());
  const auto before = (*live)->snapshot();
  EXPECT_EQ(before->index.view_count(), 3U);
  EXPECT_EQ(before->stable_poses->size(), 1U);
  ASSERT_THAT((*catalogue)->DeleteView(FlatPoseOf("wedge") + "/views/turn-1"), IsOk());
  const auto between = (*live)->snapshot();
  EXPECT_EQ(between->index.view_count(), 2U);
  EXPECT_EQ(between->revision, before->revision + 1);
  ASSERT_THAT((*catalogue)->DeleteObject("objects/wedge", /*force=*/true, ""), IsOk());
  const auto after = (*live)->snapshot();
  EXPECT_EQ(after->index.view_count(), 0U);
  EXPECT_EQ(after->stable_poses->size(), 0U);
  EXPECT_EQ(before->index.view_count(), 3U);
  EXPECT_EQ(before->stable_poses->size(), 1U);
}

TEST_F(LiveCatalogueTest, ChangedGraspsAreSeenByTheVeryNextSnapshot) {
  Declare("wedge");
  server_.reset();
  const auto catalogue = storage::Catalogue::Open(options_.database);
  ASSERT_THAT(catalogue, IsOk());
  const auto live = server::LiveCatalogue::Follow(**catalogue, ParametersOf(options_));
  ASSERT_THAT(live, IsOk());
  ASSERT_FALSE((*live)->snapshot()->stable_poses->at(FlatPoseOf("wedge"))->grasps.empty());
  ASSERT_THAT((*catalogue)
                  ->UpdateStablePose(FlatPoseOf("wedge"), "",
                                     [](v1::StablePose& pose) {
                                       pose.clear_grasps();
                                       return absl::OkStatus();
                                     }),
              IsOk());
  EXPECT_TRUE((*live)->snapshot()->stable_poses->at(FlatPoseOf("wedge"))->grasps.empty());
}

}  // namespace
}  // namespace graspdb::testing
