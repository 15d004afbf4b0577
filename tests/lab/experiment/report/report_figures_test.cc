#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/report/case_figures.h"
#include "lab/experiment/report/report_writer.h"
#include "tests/lab/experiment/hand_made_case.h"

namespace graspdb::lab {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST(BopCsv, PrintsPosesInTheCameraFrameInMillimetres) {
  CaseResult result{.experiment = {.name = "anywhere"}, .set = HandMadeParts()};
  Answer answer = RightAnswer(result.set, 1, 7);
  answer.world_sensor.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  answer.world_sensor.translation() = Eigen::Vector3d(0, 0, 1);
  answer.found.translation() = Eigen::Vector3d(0.1, 0.2, 0.05);
  answer.found.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z
  result.answers = {answer};
  const std::vector<std::string> lines = absl::StrSplit(BopCsv(result), '\n');
  ASSERT_THAT(lines, SizeIs(3));  // and what follows the last line's end
  EXPECT_EQ(lines[0], "scene_id,im_id,obj_id,score,R,t,time");
  // In the camera y and z are turned over: x stays, y = -0.2 m, z = 1 - 0.05 m.
  EXPECT_EQ(absl::StrReplaceAll(lines[1], {{"-0 ", "0 "}, {"-0,", "0,"}}),
            "1,7,2,0.95,0 -1 0 -1 0 0 0 0 -1,100 -200 950,0.040000");
  EXPECT_EQ(BopFileName(result.experiment.name), "graspdb_anywhere-test.csv");
}

TEST(BopCsv, NamesWhatWasAnsweredAndLeavesOutWhatWasNot) {
  const CaseResult result = HandMade();
  const std::vector<std::string> lines = absl::StrSplit(BopCsv(result), '\n');
  ASSERT_THAT(lines, SizeIs(5));
  EXPECT_THAT(lines[3],
              StartsWith("1,2,2,0.62,"));  // the answer, not the query
  EXPECT_EQ(BopFileName(result.experiment.name), "graspdb_hidden20-test.csv");
}

TEST(BopCsv, OfFramesHasTheMeshInTheCameraFrame) {
  FrameDetection found{.object = "nut", .score = 0.75};
  found.sensor_mesh.translation() = Eigen::Vector3d(0.1, 0, 0.8);
  FrameResult frame{.milliseconds = 40};
  frame.detections = {found};
  const std::vector<std::string> objects = {"bolt", "nut"};
  EXPECT_EQ(BopCsv({FrameResult(), frame}, objects),
            "scene_id,im_id,obj_id,score,R,t,time\n"
            "1,1,2,0.75,1 0 0 0 1 0 0 0 1,100 0 800,0.040000\n");
  EXPECT_EQ(BopObjects(objects), "case,obj_id,object,stable_pose\nframes,1,bolt,\nframes,2,nut,\n");
}

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
