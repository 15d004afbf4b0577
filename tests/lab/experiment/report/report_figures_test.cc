#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lab/experiment/experiment.h"
#include "lab/experiment/report/case_figures.h"
#include "lab/experiment/report/report_json.h"
#include "tests/lab/experiment/hand_made_case.h"

namespace graspdb::lab {
namespace {

using ::testing::ElementsAre;

// Everything that reached a stage has passed those before.
TEST(StageTable, CountsTruePosesByStageAndArrangement) {
  RealFrame separated{
      .name = {}, .path = {}, .sensor = {}, .arrangement = "tabletop, separated", .objects = {}};
  RealFrame heap = separated;
  heap.arrangement = "heap";
  const FrameInstance found{.object = {}, .found = true, .by_segments = PoseStage::kBest};
  const FrameInstance lost{
      .object = {}, .by_segments = PoseStage::kKept, .in_image = PoseStage::kRefined};
  const std::vector<FrameResult> results = {{.frame = &separated, .instances = {found, lost}},
                                            {.frame = &heap, .instances = {FrameInstance()}}};
  EXPECT_THAT(StageTable(results),
              ElementsAre(ElementsAre("true poses", "separated", "other", "all", "by segments",
                                      "in the image"),
                          ElementsAre("all", "2", "1", "3", "", ""),
                          ElementsAre("proposed", "2", "0", "2", "2", "1"),
                          ElementsAre("kept", "2", "0", "2", "2", "1"),
                          ElementsAre("refined", "2", "0", "2", "1", "1"),
                          ElementsAre("best of its object", "1", "0", "1", "1", "0"),
                          ElementsAre("accepted", "1", "0", "1", "", "")));
}

TEST(CaseFigures, CountObjectByObject) {
  const CaseResult result = HandMade();
  const std::string& first = result.set.parts[0].object_id;
  for (const ObjectFigures& f : FiguresByObject(result)) {
    if (f.object != first) continue;
    EXPECT_EQ(f.query_count, 2U);
    EXPECT_EQ(f.falsely_named, 0.5);
    EXPECT_EQ(f.right_poses, 1U);
    EXPECT_NEAR(f.mean_translation_mm, 0.5, 1e-9);
    return;
  }
  FAIL() << "no figures of " << first;
}

TEST(CaseFigures, TakeTimeByScene) {
  CaseResult result = HandMade();
  result.answers.push_back(result.answers.back());  // another object in the last scene
  const TimeFigures times = TimesOf(result);
  EXPECT_EQ(times.scenes, 5U);
  EXPECT_EQ(times.mean_ms, 60);
  EXPECT_EQ(times.median_ms, 60);
  EXPECT_EQ(times.p95_ms, 100);
}

TEST(WorstFirst, PutsWrongObjectsBeforeFarPoses) {
  CaseResult result = HandMade();
  result.answers[1].error.hausdorff_m = 0.01;
  EXPECT_THAT(WorstFirst(result), ElementsAre(2, 3, 1, 0));
}

}  // namespace
}  // namespace graspdb::lab
