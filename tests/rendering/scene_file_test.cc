#include "rendering/scene_file.h"

#include <gmock/gmock.h>

#include "rendering/sample_parts.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::rendering {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

TEST(SceneFile, RoundTrip) {
  const files::TemporaryFolder folder;
  const std::vector<Workpiece> parts = SampleParts();
  const auto scenes = PlanRandomScenes(parts, {.stand = {}, .count = 3, .objects_per_scene = 2});
  ASSERT_THAT(scenes, IsOk());
  std::vector<std::uint64_t> seeds;
  for (const PlannedCapture& scene : *scenes) {
    ASSERT_THAT(WriteScenes(folder.path() / "table", parts, {scene}), IsOk());
    const auto read = ReadScene(folder.path() / "table", parts);
    ASSERT_THAT(read, IsOk());
    ASSERT_EQ(read->placements.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(read->placements[i].part, scene.placements[i].part);
      EXPECT_TRUE(
          read->placements[i].world_object.isApprox(scene.placements[i].world_object, 1e-12));
    }
    EXPECT_TRUE(read->world_sensor.isApprox(scene.world_sensor, 1e-12));
    EXPECT_EQ(ReadScene(folder.path() / "table", parts)->seed, read->seed);
    seeds.push_back(read->seed);
  }
  EXPECT_NE(seeds[0], seeds[1]);
}

TEST(SceneFile, IsUnavailableWithoutAFolder) {
  const files::TemporaryFolder folder;
  EXPECT_THAT(ReadScene(folder.path() / "nowhere", SampleParts()),
              StatusIs(absl::StatusCode::kUnavailable));
}

TEST(SceneFile, RejectsSeveralScenes) {
  const files::TemporaryFolder folder;
  const std::vector<Workpiece> parts = SampleParts();
  const auto scenes = PlanRandomScenes(parts, {.stand = {}, .count = 2, .objects_per_scene = 2});
  ASSERT_THAT(scenes, IsOk());
  ASSERT_THAT(WriteScenes(folder.path(), parts, *scenes), IsOk());
  EXPECT_THAT(ReadScene(folder.path(), parts),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("more than one scene")));
}

TEST(SceneFile, RejectsUnknownObjects) {
  const files::TemporaryFolder folder;
  const std::vector<Workpiece> parts = SampleParts();
  ASSERT_THAT(WriteScenes(folder.path(), parts,
                          {{.path = "p", .placements = {{3, recognition::Pose::Identity()}}}}),
              IsOk());
  EXPECT_THAT(ReadScene(folder.path(), {parts[0]}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(parts[3].object_id)));
}

}  // namespace
}  // namespace graspdb::rendering
