#include <gmock/gmock.h>
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "lab/experiment/report/case_figures.h"
#include "lab/experiment/report/case_section.h"
#include "lab/experiment/report/match_drawing.h"
#include "lab/experiment/report/matching_scores.h"
#include "lab/experiment/report/report_html.h"
#include "lab/experiment/report/report_markdown.h"
#include "lab/experiment/report/report_writer.h"
#include "tests/lab/experiment/hand_made_case.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

namespace fs = std::filesystem;
using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

std::string TextOf(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

class ReportFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("report_") + test->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(ReportFolder, HoldsAllFilesAfterEveryCase) {
  auto writer = ReportWriter::Create(folder_, "graspdb eval a.ply");
  ASSERT_THAT(writer, IsOk());
  EXPECT_THAT(TextOf(folder_ / "report.html"), HasSubstr("No case has ended yet"));
  ASSERT_THAT(writer->Add(HandMade("first")), IsOk());
  EXPECT_THAT(TextOf(folder_ / "report.html"), HasSubstr("id=\"case-first\""));
  EXPECT_THAT(TextOf(folder_ / "graspdb_first-test.csv"), HasSubstr("scene_id,"));
  const std::string figure =
      TextOf(folder_ / "figures/first-mean-absolute-rotation-error-for-each-object.svg");
  EXPECT_THAT(figure, ::testing::StartsWith("<svg xmlns="));
  EXPECT_THAT(figure, HasSubstr("<style>"));
  EXPECT_THAT(figure, ::testing::EndsWith("</svg>\n"));
  ASSERT_THAT(writer->Add(HandMade("second")), IsOk());
  const std::string page = TextOf(writer->page_path());
  EXPECT_THAT(page, HasSubstr("id=\"case-first\""));
  EXPECT_THAT(page, HasSubstr("id=\"case-second\""));
  EXPECT_THAT(TextOf(folder_ / "cases.md"), HasSubstr("| second | 5 | 50.0 | 50.0 | 50.0 |"));
  EXPECT_THAT(TextOf(folder_ / "bop_objects.csv"), HasSubstr("\nsecond,1,"));
}

TEST_F(ReportFolder, IsTheSameForTheSameCases) {
  std::vector<std::string> reports;
  for (int i = 0; i < 2; ++i) {
    auto writer = ReportWriter::Create(folder_, "graspdb eval");
    ASSERT_THAT(writer, IsOk());
    ASSERT_THAT(writer->Add(HandMade()), IsOk());
    reports.push_back(TextOf(folder_ / "report.json") + TextOf(folder_ / "report.html"));
  }
  EXPECT_EQ(reports[0], reports[1]);
}

TEST_F(ReportFolder, IsRefusedWhereAFileIs) {
  std::ofstream(folder_) << "something else";
  EXPECT_THAT(ReportWriter::Create(folder_, "graspdb eval"),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("is a file")));
  EXPECT_EQ(TextOf(folder_), "something else");
}

TEST_F(ReportFolder, JsonHoldsTheNumbersOfTheCase) {
  auto writer = ReportWriter::Create(folder_, "graspdb eval 'a \"b\".ply'");
  ASSERT_THAT(writer, IsOk());
  ASSERT_THAT(writer->Add(HandMade()), IsOk());
  google::protobuf::Struct document;
  ASSERT_TRUE(
      google::protobuf::util::JsonStringToMessage(TextOf(folder_ / "report.json"), &document).ok());
  EXPECT_EQ(document.fields().at("command").string_value(), "graspdb eval 'a \"b\".ply'");
  const auto& cases = document.fields().at("cases").list_value();
  ASSERT_EQ(cases.values_size(), 1);
  const auto& fields = cases.values(0).struct_value().fields();
  const auto& settings = fields.at("settings").struct_value().fields();
  EXPECT_EQ(settings.at("hidden_share").number_value(), 0.2);
  EXPECT_EQ(settings.at("asked").struct_value().fields().at("camera").string_value(), "Kinect v2");
  const auto& summary = fields.at("summary").struct_value().fields();
  EXPECT_EQ(summary.at("known").number_value(), 4);
  EXPECT_EQ(summary.at("object_right").number_value(), 0.5);
  EXPECT_EQ(summary.at("unknown_rejected").number_value(), 1);
  const auto& answers = fields.at("answers").list_value();
  ASSERT_EQ(answers.values_size(), 5);
  const auto& right = answers.values(0).struct_value().fields();
  EXPECT_NEAR(right.at("add_s_mm").number_value(), 1, 1e-9);
  EXPECT_EQ(right.at("outcome").string_value(), "OK");
  const auto& taken = answers.values(2).struct_value().fields();
  EXPECT_EQ(taken.at("score").number_value(), 0.62);
  EXPECT_EQ(taken.at("add_s_mm").kind_case(), google::protobuf::Value::kNullValue);
}

// A camera one metre above the origin that looks straight down.
TEST(ReportHtml, EscapesNamesAndRefersToNothingOutside) {
  CaseResult result = HandMade("case <i>&\"");
  result.set.parts[0].object_id = "<b>&\"";
  const std::string page = ReportHtml({.command = "graspdb eval '<script>'",
                                       .rows = {RowOf(result)},
                                       .sections = {CaseSection(result)},
                                       .descriptors = {}});
  EXPECT_THAT(page, Not(HasSubstr("<b>&")));
  EXPECT_THAT(page, Not(HasSubstr("<i>&")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, HasSubstr("&lt;b&gt;&amp;&quot;"));
  const std::string inside =
      absl::StrReplaceAll(page, {{"xmlns=\"http://www.w3.org/2000/svg\"", ""}});
  EXPECT_THAT(inside, HasSubstr("<svg"));
  EXPECT_THAT(inside, Not(HasSubstr("http")));
}

TEST(ReportHtml, ShowsDescriptorsSideBySide) {
  const std::string page =
      ReportHtml({.command = "",
                  .rows = {},
                  .sections = {},
                  .descriptors = {{"VFH-263", "L1", {{"cup", 0.5}, {"can", 0.25}}, 0.125, 96},
                                  {"MVFH-300", "L1", {{"cup", 0.125}, {"can", 0}}, 0, 96},
                                  {"MVFH-300", "chi-square", {{"cup", 0}, {"can", 0}}, 0, 96}}});
  EXPECT_THAT(page, HasSubstr("<td>VFH-263</td><td>37.50 / 12.50</td><td>–</td>"));
  EXPECT_THAT(page, HasSubstr("<td>MVFH-300</td><td>6.25 / 0.00</td><td>0.00 / 0.00</td>"));
  EXPECT_THAT(page, HasSubstr("<title>cup, MVFH-300, L1: 12.5 %</title>"));
}

TEST(CaseSection, OfNothingAskedSaysSo) {
  EXPECT_THAT(CaseSection({.experiment = {.name = "empty"}, .set = {}}),
              HasSubstr("Nothing was asked"));
}

TEST(CaseSection, OfStrangersOnlyHasNoPoseErrors) {
  CaseResult result = HandMade("unknown");
  result.answers.erase(result.answers.begin(), result.answers.end() - 1);
  const std::string section = CaseSection(result);
  EXPECT_THAT(section, HasSubstr("Named although it was not taught"));
  EXPECT_THAT(section, Not(HasSubstr("Pose error")));
}

TEST(CaseSection, ListsPairsWhereAMatrixWouldBeTooLarge) {
  CaseResult result = HandMade();
  for (int i = 0; i < 40; ++i) {
    result.set.Add(result.set, 0);
    result.set.parts.back().object_id = "part-" + std::to_string(i);
    result.answers.push_back(RightAnswer(result.set, result.set.parts.size() - 1, 10));
  }
  const std::string section = CaseSection(result);
  const auto& parts = result.set.parts;
  EXPECT_THAT(section, HasSubstr("<tr><td>" + parts[0].object_id + "</td><td>" +
                                 parts[1].object_id + "</td><td>1</td></tr>"));
  // Nothing is the right answer about what was not taught.
  EXPECT_THAT(section, Not(HasSubstr("<td>" + parts[3].object_id + "</td><td>(none)</td>")));
  EXPECT_THAT(section, Not(HasSubstr("<title>asked ")));
}

TEST(MatchDrawings, ShowScanTruthAndMatch) {
  CaseResult result = HandMade();
  for (Answer& answer : result.answers) answer.world_sensor = LookAt({0, 0, 0}, 0.8, 40, -90);
  result.scans[2] = {{0, 0, 0.02F}, {0.01F, 0, 0.02F}};
  const std::string drawings = MatchDrawings(result);
  const auto count = [&](const std::string& what) {
    return std::vector<std::string>(absl::StrSplit(drawings, what)).size() - 1;
  };
  EXPECT_EQ(count("<title>scan</title>"), 1U);
  EXPECT_EQ(count("<title>truth</title>"), 4U);
  EXPECT_EQ(count("<title>match</title>"), 3U);  // one question was not answered
}

TEST(MatchingScores, FrameTheViewThatBecameTheAnswer) {
  CaseResult result = HandMade();
  for (int i = 0; i < 12; ++i) {
    auto view = std::make_shared<recognition::TaughtView>();
    view->name = StablePoseName(result.set.parts[0]) + "/views/" + std::to_string(i);
    view->stable_pose = StablePoseName(result.set.parts[0]);
    result.answers[2].candidates.push_back({view, 0.1 * i, std::nullopt});
  }
  result.answers[2].view = result.answers[2].candidates[3].view->name;
  const std::string scores = MatchingScores(result);
  EXPECT_THAT(scores, HasSubstr("the 10 views with the nearest"));
  EXPECT_THAT(scores, HasSubstr("class=\"mark\""));
  result.answers[2].view = result.answers[2].candidates[11].view->name;
  EXPECT_THAT(MatchingScores(result), Not(HasSubstr("class=\"mark\"")));
}

TEST(TableMarkdown, KeepsItsColumns) {
  CaseRow row = RowOf(HandMade("a|b"));
  const std::vector<std::string> lines = absl::StrSplit(TableMarkdown(CaseTable({row})), '\n');
  ASSERT_THAT(lines, SizeIs(4));
  EXPECT_THAT(lines[2], HasSubstr("| a\\|b | 5 |"));
}

}  // namespace
}  // namespace graspdb::client
