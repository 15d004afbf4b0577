// The catalogue in memory: it follows every change, and recomputes descriptors when the
// server's parameters change.
#include "server/live/live_catalogue.h"

#include <gmock/gmock.h>

#include "server/live/records.h"
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

TEST_F(LiveCatalogueTest, RestartWithAnotherVoxelSizeRecomputesDescriptors) {
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

TEST_F(LiveCatalogueTest, RestartWithAnotherDescriptorRecomputesDescriptors) {
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

TEST_F(LiveCatalogueTest, ACancelledStartKeepsWhatItHasDescribed) {
  Teach("wedge", 4);
  const std::int64_t revision = Status().catalog_revision();
  server_.reset();
  options_.voxel_size_m = 0.005;
  int views = 0;
  EXPECT_THAT(server::Server::Start(options_, [&views] { return views++ == 3; }),
              StatusIs(absl::StatusCode::kCancelled));
  EXPECT_EQ(views, 4);
  Start();
  EXPECT_EQ(Status().catalog_revision(), revision + 2) << "three views, then one";
  EXPECT_EQ(Status().left_out_record_count(), 0);
  EXPECT_EQ(Answer(request_).status(), v1::OK);
}

TEST_F(LiveCatalogueTest, ViewsCanBeTaughtAfterARestartThatRecomputedDescriptors) {
  Teach("wedge", 2);
  options_.descriptor = "vfh263";
  Restart();
  Teach("handle", 2);
  EXPECT_EQ(Status().view_count(), 4);
}

TEST_F(LiveCatalogueTest, UnusableParametersAreRejected) {
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

// Stores a view whose sensor pose is not a rotation, one with an invalid cloud (and therefore no
// descriptor for the server's parameters), and a stable pose that no request could create.
void StoreUnusable(storage::Catalogue& catalogue) {
  auto taught = catalogue.GetView(FlatPoseOf("wedge") + "/views/turn-0");
  ASSERT_THAT(taught, IsOk());
  storage::NewView view = {*taught, *catalogue.GetPackedCloud(taught->name())};
  view.record.set_name(FlatPoseOf("wedge") + "/views/no-pose");
  view.record.mutable_sensor_pose()->clear_orientation();
  ASSERT_THAT(catalogue.PutView(view), IsOk());
  v1::StablePose pose;
  pose.set_name("objects/wedge/stablePoses/odd");
  pose.set_symmetry_order(1000);
  ASSERT_THAT(catalogue.CreateStablePose(pose), IsOk());
  view = {*taught, "no cloud"};
  view.record.set_name("objects/wedge/stablePoses/odd/views/no-cloud");
  view.record.clear_descriptors();
  ASSERT_THAT(catalogue.PutView(view), IsOk());
}

TEST_F(LiveCatalogueTest, UnusableRecordsAreLeftOutAtTheStart) {
  Teach("wedge", 2);
  const v1::RecognizeResponse before = Answer(request_);
  server_.reset();
  {
    const auto catalogue = storage::Catalogue::Open(options_.database);
    ASSERT_THAT(catalogue, IsOk());
    StoreUnusable(**catalogue);
  }
  for (const double voxel_size_m : {0.003, 0.0035, 0.003}) {
    options_.voxel_size_m = voxel_size_m;
    Start();
    EXPECT_EQ(Status().left_out_record_count(), 3);
    EXPECT_EQ(Status().view_count(), 4);
    EXPECT_EQ(Answer(request_).detections(0).object(), "objects/wedge");
    server_.reset();
  }
  Start();
  EXPECT_EQ(Answer(request_).detections(0).SerializeAsString(),
            before.detections(0).SerializeAsString());
}

TEST_F(LiveCatalogueTest, UnusableRecordsAreLeftOutUntilTheyAreDeleted) {
  Teach("wedge", 2);
  server_.reset();
  const auto catalogue = storage::Catalogue::Open(options_.database);
  ASSERT_THAT(catalogue, IsOk());
  const auto live = server::LiveCatalogue::Follow(**catalogue, ParametersOf(options_));
  ASSERT_THAT(live, IsOk());
  StoreUnusable(**catalogue);
  EXPECT_EQ((*live)->left_out_count(), 3);
  EXPECT_EQ((*live)->snapshot()->index.view_count(), 2U);
  ASSERT_THAT((*catalogue)->DeleteView(FlatPoseOf("wedge") + "/views/no-pose"), IsOk());
  EXPECT_EQ((*live)->left_out_count(), 2);
  ASSERT_THAT((*catalogue)->DeleteObject("objects/wedge", /*force=*/true, ""), IsOk());
  EXPECT_EQ((*live)->left_out_count(), 0);
  EXPECT_EQ((*live)->snapshot()->stable_poses->size(), 0U);
}

TEST_F(LiveCatalogueTest, MissedChangeIsAppliedWithTheNextOne) {
  Teach("wedge", 3);
  server_.reset();
  const auto catalogue = storage::Catalogue::Open(options_.database);
  ASSERT_THAT(catalogue, IsOk());
  const auto live = server::LiveCatalogue::Follow(**catalogue, ParametersOf(options_));
  ASSERT_THAT(live, IsOk());
  const auto listen = [&](const storage::ChangeRecord& change) { (*live)->Apply(change); };
  ASSERT_THAT((*catalogue)->Subscribe({}), IsOk());
  ASSERT_THAT((*catalogue)->DeleteView(FlatPoseOf("wedge") + "/views/turn-1"), IsOk());
  ASSERT_THAT((*catalogue)->Subscribe(listen), IsOk());
  EXPECT_EQ((*live)->snapshot()->index.view_count(), 3U);
  ASSERT_THAT((*catalogue)->DeleteView(FlatPoseOf("wedge") + "/views/turn-2"), IsOk());
  EXPECT_EQ((*live)->snapshot()->index.view_count(), 1U);
  EXPECT_EQ((*live)->snapshot()->revision, (*catalogue)->revision());
}

TEST_F(LiveCatalogueTest, SnapshotIsImmutable) {
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

TEST_F(LiveCatalogueTest, ChangedGraspsAreInTheNextSnapshot) {
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
