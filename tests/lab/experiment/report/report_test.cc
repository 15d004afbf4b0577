#include <gmock/gmock.h>
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "lab/experiment/report/report_json.h"
#include "lab/experiment/report/report_writer.h"
#include "tests/lab/experiment/hand_made_case.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

namespace fs = std::filesystem;
using google::protobuf::Value;
using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

TEST_F(ReportFolder, HoldsAllCasesAfterEachOfThem) {
  auto writer = ReportWriter::Create(folder_, "graspdb eval a.ply");
  ASSERT_THAT(writer, IsOk());
  EXPECT_THAT(TextOf(folder_ / "report.json"), HasSubstr("\"cases\": []"));
  ASSERT_THAT(writer->Add(HandMade("first")), IsOk());
  EXPECT_THAT(TextOf(folder_ / "report.json"), HasSubstr("\"name\": \"first\""));
  ASSERT_THAT(writer->Add(HandMade("second")), IsOk());
  EXPECT_THAT(TextOf(folder_ / "report.json"),
              AllOf(HasSubstr("\"name\": \"first\""), HasSubstr("\"name\": \"second\"")));
}

TEST_F(ReportFolder, IsTheSameForTheSameCases) {
  std::vector<std::string> reports;
  for (int i = 0; i < 2; ++i) {
    auto writer = ReportWriter::Create(folder_, "graspdb eval");
    ASSERT_THAT(writer, IsOk());
    ASSERT_THAT(writer->Add(HandMade()), IsOk());
    reports.push_back(TextOf(folder_ / "report.json"));
  }
  EXPECT_EQ(reports[0], reports[1]);
}

// Its numbers of objects are those of another bop_objects.csv.
TEST_F(ReportFolder, HasNothingOfAnEarlierReport) {
  const std::vector<std::string> made = {"cases.md",        "descriptors.md",
                                         "stages.md",       "report.html",
                                         "bop_objects.csv", "graspdb_first-test.csv"};
  ASSERT_THAT(ReportWriter::Create(folder_, "graspdb eval"), IsOk());
  for (const std::string& name : made) std::ofstream(folder_ / name) << "of graspdb-eval-report";
  std::ofstream(folder_ / "notes.csv") << "mine";
  ASSERT_THAT(ReportWriter::Create(folder_, "graspdb eval"), IsOk());
  for (const std::string& name : made) EXPECT_FALSE(fs::exists(folder_ / name)) << name;
  EXPECT_EQ(TextOf(folder_ / "notes.csv"), "mine");
}

// Without a report, files of these names are not graspdb's.
TEST_F(ReportFolder, KeepsFilesOfAFolderWithoutAReport) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "graspdb_lm-test.csv") << "mine";
  ASSERT_THAT(ReportWriter::Create(folder_, "graspdb eval"), IsOk());
  EXPECT_EQ(TextOf(folder_ / "graspdb_lm-test.csv"), "mine");
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
  EXPECT_EQ(settings.at("queried").struct_value().fields().at("camera").string_value(),
            "Kinect v2");
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

TEST(CaseAsJson, ACaptureSetHasNoSettingsOfASimulation) {
  CaseResult result = HandMade();
  result.experiment.is_simulated = false;
  const Value json = CaseAsJson(result);
  const auto& settings = json.struct_value().fields().at("settings").struct_value().fields();
  EXPECT_EQ(settings.at("parts").number_value(), 4);
  EXPECT_EQ(settings.at("taught_parts").number_value(), 3);
  EXPECT_EQ(settings.size(), 2U) << "a camera, step or seed that was not used";
}

// An error of 0 would be that of a perfect pose.
TEST(CaseAsJson, AnAnswerWithoutATruePoseHasNoError) {
  CaseResult result = HandMade();
  result.answers[0].posed = false;
  result.answers[0].file = "clouds/a.pcd";
  const Value json = CaseAsJson(result);
  const auto& answers = json.struct_value().fields().at("answers").list_value();
  const auto& unposed = answers.values(0).struct_value().fields();
  EXPECT_FALSE(unposed.at("posed").bool_value());
  EXPECT_EQ(unposed.at("file").string_value(), "clouds/a.pcd");
  for (const char* key : {"add_s_mm", "add_s_share", "farthest_mm", "rotation_deg"}) {
    EXPECT_EQ(unposed.at(key).kind_case(), Value::kNullValue) << key;
  }
  EXPECT_TRUE(answers.values(1).struct_value().fields().at("posed").bool_value());
  const auto& summary = json.struct_value().fields().at("summary").struct_value().fields();
  EXPECT_EQ(summary.at("posed").number_value(), 3);
}

TEST(CaseAsJson, DrawsTheWorstAnswers) {
  CaseResult result = HandMade();
  for (Answer& answer : result.answers)
    answer.world_sensor = rendering::LookAt({0, 0, 0}, 0.8, 40, -90);
  result.scans[2] = {{0, 0, 0.02F}, {0.01F, 0, 0.02F}};
  const Value json = CaseAsJson(result);
  const auto& drawings = json.struct_value().fields().at("drawings").list_value();
  ASSERT_EQ(drawings.values_size(), 4);  // all but the unknown object that was rejected
  const auto& worst = drawings.values(0).struct_value().fields();
  EXPECT_EQ(worst.at("scan").struct_value().fields().at("u").list_value().values_size(), 2);
  EXPECT_TRUE(worst.contains("truth"));
  EXPECT_TRUE(worst.contains("match"));
  const auto& unanswered = drawings.values(1).struct_value().fields();
  EXPECT_FALSE(unanswered.contains("scan"));
  EXPECT_FALSE(unanswered.contains("match"));
}

TEST(CaseAsJson, MarksTheViewThatBecameTheAnswer) {
  CaseResult result = HandMade();
  const auto chosen = [&result] {
    std::vector<bool> out;
    const Value json = CaseAsJson(result);
    const auto& first = json.struct_value().fields().at("first_matches").struct_value().fields();
    for (const Value& view : first.at("views").list_value().values()) {
      out.push_back(view.struct_value().fields().at("chosen").bool_value());
    }
    return out;
  };
  for (int i = 0; i < 12; ++i) {
    auto view = std::make_shared<recognition::TaughtView>();
    view->name = StablePoseName(result.set.parts[0]) + "/views/" + std::to_string(i);
    view->stable_pose = StablePoseName(result.set.parts[0]);
    result.answers[2].candidates.push_back({view, 0.1 * i, std::nullopt});
  }
  result.answers[2].view = result.answers[2].candidates[3].view->name;
  std::vector<bool> fourth(10, false);
  fourth[3] = true;
  EXPECT_EQ(chosen(), fourth);
  result.answers[2].view = result.answers[2].candidates[11].view->name;
  EXPECT_EQ(chosen(), std::vector<bool>(10, false));
}

// In the camera y and z are turned over: x stays, y = -0.2 m, z = 1 - 0.05 m.
TEST(CaseAsJson, HasTheAnsweredPoseInTheCamerasFrame) {
  CaseResult result{.experiment = {.name = "anywhere"}, .set = HandMadeParts()};
  Answer answer = RightAnswer(result.set, 1, 7);
  answer.world_sensor.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  answer.world_sensor.translation() = Eigen::Vector3d(0, 0, 1);
  answer.found.translation() = Eigen::Vector3d(0.1, 0.2, 0.05);
  answer.found.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z
  result.answers = {answer};
  const Value json = CaseAsJson(result);
  const auto& parts = json.struct_value().fields().at("parts").list_value();
  EXPECT_EQ(parts.values(1).struct_value().fields().at("object").string_value(),
            result.set.parts[1].object_id);
  const auto& fields =
      json.struct_value().fields().at("answers").list_value().values(0).struct_value().fields();
  EXPECT_EQ(fields.at("part_answered").number_value(), 2);
  const auto numbers = [&](const char* key) {
    std::vector<double> out;
    const auto& pose = fields.at("camera_object").struct_value().fields();
    for (const Value& value : pose.at(key).list_value().values()) {
      out.push_back(value.number_value());
    }
    return out;
  };
  EXPECT_THAT(numbers("rotation"), ElementsAre(0, -1, 0, -1, 0, 0, 0, 0, -1));
  EXPECT_THAT(numbers("translation_mm"),
              ElementsAre(DoubleNear(100, 1e-9), DoubleNear(-200, 1e-9), DoubleNear(950, 1e-9)));
}

// The answer, not the query; none where nothing was answered.
TEST(CaseAsJson, APoseIsOfThePartThatWasAnswered) {
  const Value json = CaseAsJson(HandMade());
  const auto& answers = json.struct_value().fields().at("answers").list_value();
  EXPECT_EQ(answers.values(2).struct_value().fields().at("part_answered").number_value(), 2);
  EXPECT_FALSE(answers.values(3).struct_value().fields().contains("part_answered"));
  EXPECT_FALSE(answers.values(3).struct_value().fields().contains("camera_object"));
}

}  // namespace
}  // namespace graspdb::lab
