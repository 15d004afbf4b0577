#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "lab/experiment/kept_scans.h"
#include "lab/experiment/report/bop_csv.h"
#include "lab/experiment/report/case_curves.h"
#include "lab/experiment/report/case_figures.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/plot.h"
#include "tests/lab/experiment/hand_made_case.h"

namespace graspdb::client {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST(BopCsv, TellsPosesInTheCameraFrameInMillimetres) {
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
  EXPECT_EQ(BopFileName(result.experiment), "graspdb_anywhere-test.csv");
}

TEST(BopCsv, NamesWhatWasAnsweredAndLeavesOutWhatWasNot) {
  const CaseResult result = HandMade();
  const std::vector<std::string> lines = absl::StrSplit(BopCsv(result), '\n');
  ASSERT_THAT(lines, SizeIs(5));
  EXPECT_THAT(lines[3],
              StartsWith("1,2,2,0.62,"));  // what was answered, not what was asked
  EXPECT_EQ(BopFileName(result.experiment), "graspdb_hidden20-test.csv");
}

TEST(CaseFigures, CountObjectByObject) {
  const CaseResult result = HandMade();
  const std::string& first = result.set.parts[0].object_id;
  for (const ObjectFigures& f : FiguresByObject(result)) {
    if (f.object != first) continue;
    EXPECT_EQ(f.asked, 2U);
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

TEST(CaseCurves, FallWithTheirThresholds) {
  const CaseResult result = HandMade();
  const Curve recall = RecallOverAddS(result);
  EXPECT_EQ(recall.front().second, 0);  // 1 mm off is not 0 mm off
  EXPECT_EQ(recall.back().second, 0.5);
  const ScoreCurves curves = OverScore(result);
  EXPECT_NEAR(curves.precision.front().second, 2.0 / 3, 1e-9);
  EXPECT_LT(curves.precision.back().first, 0.95 + 1e-9);  // nothing is left above
  EXPECT_EQ(curves.precision.back().second, 1);           // without the one of 0.62
  EXPECT_EQ(curves.recall.back().second, 0);
  const std::vector<ScoreBin> bins = ReliabilityBins(result);
  EXPECT_EQ(bins[6].count, 1U);
  EXPECT_EQ(bins[6].right, 0);
  EXPECT_EQ(bins[9].count, 2U);
  EXPECT_EQ(bins[9].right, 1);
}

TEST(CaseCurves, ConfusionsKeepWhatWasNotAnswered) {
  const CaseResult result = HandMade();
  const Confusions confusions = ConfusionsOf(result);
  const std::string& first = result.set.parts[0].object_id;
  const std::string& second = result.set.parts[1].object_id;
  EXPECT_EQ(confusions.at({first, second}), 1U);
  EXPECT_EQ(confusions.at({second, ""}), 1U);
}

TEST(WorstFirst, PutsWrongObjectsBeforeFarPoses) {
  CaseResult result = HandMade();
  result.answers[1].error.hausdorff_m = 0.01;
  EXPECT_THAT(WorstFirst(result), ElementsAre(2, 3, 1, 0));
}

TEST(BarChart, IsAsWideAsItsLegend) {
  BarChart chart;
  chart.categories = {"a"};
  std::vector<std::string> names;
  for (int i = 0; i < 5; ++i) {
    names.push_back(std::string(40, 'x'));
    chart.series.push_back({.name = names.back(), .values = {1}});
  }
  const std::string svg = DrawBars(chart);
  const std::size_t width = svg.find("width=\"") + 7;
  EXPECT_GT(std::stod(svg.substr(width)), LegendWidth(names));
}

TEST(Markup, WritesNumbersAsTheyAreRead) {
  EXPECT_EQ(Readable(0), "0");
  EXPECT_EQ(Readable(0.1), "0.1");
  EXPECT_EQ(Readable(12.345), "12.3");
  EXPECT_EQ(Readable(100), "100");
  EXPECT_EQ(Px(-0.01), "0");
  EXPECT_EQ(Px(12), "12");
}

}  // namespace
}  // namespace graspdb::client
