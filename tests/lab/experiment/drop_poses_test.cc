#include <gmock/gmock.h>

#include <algorithm>

#include "lab/experiment/experiment.h"
#include "lab/experiment/trials/part_set.h"
#include "rendering/meshes/mesh_file.h"
#include "rendering/meshes/solid.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;

class DropPosesTest : public ::testing::Test {
 protected:
  absl::StatusOr<PartSet> Fall(const rendering::TriangleMesh& mesh,
                               const DropPoseSelection& selection) const {
    EXPECT_THAT(rendering::WriteMeshPly(folder_.path() / "object.ply", mesh), IsOk());
    return DropPoses({folder_.path() / "object.ply"}, 1, selection);
  }

  const files::TemporaryFolder folder_;
};

TEST_F(DropPosesTest, AreQueriedByTheirProbability) {
  const auto set =
      Fall(rendering::BoxSolid({0, 0, 0}, {0.03F, 0.06F, 0.09F}), {.falls = 400, .seed = 3});
  ASSERT_THAT(set, IsOk());
  EXPECT_EQ(set->taught_count, 3U) << "a box looks the same on opposite faces";
  EXPECT_EQ(set->parts.size() - set->taught_count, 6U) << "and comes to rest on all";
  EXPECT_EQ(set->queried_parts.size(), 400U);
  std::size_t flat = 0;
  for (const std::size_t part : set->queried_parts) {
    EXPECT_TRUE(set->IsTaught(part));
    flat += rendering::BoundsOf(set->parts[part].mesh).max.z() < 0.031 ? 1 : 0;
  }
  // Both large faces: 4 atan(...) / 4 pi each.
  EXPECT_NEAR(static_cast<double>(flat) / 400, 0.655, 0.06);
}

TEST_F(DropPosesTest, AreRecognizedFromTheTaughtMesh) {
  const rendering::TriangleMesh angle = rendering::ExtrudeAlongY(
      {{0, 0}, {0.1F, 0}, {0.1F, 0.02F}, {0.025F, 0.02F}, {0.025F, 0.08F}, {0, 0.08F}}, 0, 0.04F);
  const auto set = Fall(angle, {.falls = 6, .seed = 1});
  ASSERT_THAT(set, IsOk());
  std::vector<ExperimentCase> cases = ExperimentCases();
  const ExperimentCase& cad = *std::ranges::find(cases, "cad", &ExperimentCase::name);
  const auto trials = RenderedTrials(cad, *set);
  ASSERT_THAT(trials, IsOk());
  EXPECT_EQ(trials->queries.count, 6U);
  const auto result = RunCase(cad, *set, *trials, {});
  ASSERT_THAT(result, IsOk());
  EXPECT_EQ(Summarize(*result).known, 6U);
  EXPECT_EQ(Summarize(*result).strictly_right, 1);
}

TEST_F(DropPosesTest, FailWithoutAMeshWithinTheSizeLimits) {
  EXPECT_THAT(Fall(rendering::BoxSolid({0, 0, 0}, {0.01F, 0.01F, 0.01F}), {}),
              StatusIs(absl::StatusCode::kFailedPrecondition));
}

}  // namespace
}  // namespace graspdb::lab
