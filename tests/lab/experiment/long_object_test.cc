// A hammer of 34 cm slides along its axis during refinement, more so when a part is hidden.
#include <gmock/gmock.h>

#include <algorithm>

#include "lab/experiment/experiment.h"
#include "tests/recognition/scenes/shared_data.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using ::graspdb::testing::IsOk;

TEST(LongObject, ConvergesWithFortyPercentHidden) {
  const auto meshes = graspdb::testing::SharedData("ycb_meshes");
  if (!meshes) GTEST_SKIP() << graspdb::testing::SharedDataMissing("ycb_meshes");
  const auto set = RestingParts({*meshes / "hammer.ply"}, 1, {});
  ASSERT_THAT(set, IsOk());
  std::vector<ExperimentCase> cases = ExperimentCases();
  ExperimentCase& hidden = *std::ranges::find(cases, "hidden-40", &ExperimentCase::name);
  hidden.seed = 2;
  const auto trials = RenderedTrials(hidden, *set);
  ASSERT_THAT(trials, IsOk());
  ExperimentRun run;
  run.parameters.matching.min_score = 0;
  const auto result = RunCase(hidden, *set, *trials, run);
  ASSERT_THAT(result, IsOk());
  EXPECT_GT(Summarize(*result).strictly_right, 0.9) << "0.875 before poses were polished";
}

}  // namespace
}  // namespace graspdb::lab
