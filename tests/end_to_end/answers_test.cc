// Output of graspdb for catalogues and scans.
#include <gmock/gmock.h>

#include <sstream>

#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::HasSubstr;

class AnswersTest : public ProgramsTest {
 protected:
  // Teaches turntable views of the part.
  void Teach(const std::string& part, int step_deg) {
    Succeed(
        {"simulate", "--parts", part, "--step", std::to_string(step_deg), "--out", Path("teach")});
    StartServer();
    Succeed({"import", Path("teach")});
  }
};

TEST_F(AnswersTest, RecognizesEveryObjectOfTwelveScenesWithGrasps) {
  StartServer();
  Succeed({"simulate", "--parts", "l-bracket,handle,wedge", "--turntable", "--step", "30",
           "--random", "12", "--seed", "2026", "--out", Path("set")});
  Succeed({"import", Path("set")});
  EXPECT_EQ(Status().view_count(), 36);
  const std::string lines = Recognize("set");
  EXPECT_EQ(CountLines(lines), 12);
  EXPECT_EQ(CountRight(lines), 12) << lines;
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) {
    const std::optional<v1::RecognizeResponse> response = ResponseOf(line);
    ASSERT_TRUE(response) << line;
    EXPECT_EQ(response->status(), v1::OK) << line;
    EXPECT_EQ(response->catalog_revision(), Status().catalog_revision());
    EXPECT_FALSE(response->detections(0).grasps().empty()) << line;
  }
}

TEST_F(AnswersTest, PrintsErrorsFromTheGroundTruth) {
  Teach("wedge", 45);
  Succeed(
      {"simulate", "--parts", "wedge", "--random", "3", "--seed", "7", "--out", Path("queries")});
  const std::string pictures = (folder_.path() / "pictures").string();
  const Finished outcome = Succeed({"recognize", Path("queries"), "--pictures", pictures});
  EXPECT_THAT(outcome.out, HasSubstr("object right 100.0 % (3 of 3)"));
  EXPECT_THAT(outcome.out, HasSubstr("(ADD-S) 100.0 % (3 of 3)"));
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(pictures)) {
    EXPECT_THAT(files::BytesOf(entry.path()), ::testing::StartsWith("\x89PNG"));
    ++count;
  }
  EXPECT_EQ(count, 3);
}

TEST_F(AnswersTest, RecognizesASingleFileByItsSensorPose) {
  Teach("wedge", 45);
  const std::string file = Path("teach") + "/clouds/wedge_0001.pcd";
  const std::string line = Succeed({"recognize", file, "--json"}).out;
  EXPECT_THAT(line, ::testing::StartsWith("{\"path\":\"" + file + "\""));
  const auto response = ResponseOf(line.substr(0, line.find('\n')));
  ASSERT_TRUE(response) << line;
  EXPECT_EQ(response->world_frame_source(), v1::WORLD_FRAME_SOURCE_REQUEST);
  ASSERT_EQ(response->detections_size(), 1);
  EXPECT_EQ(response->detections(0).object(), "objects/wedge");
}

TEST_F(AnswersTest, ListsShowsAndDeletesObjects) {
  Teach("wedge", 180);
  EXPECT_THAT(Succeed({"objects", "list"}).out, HasSubstr("objects/wedge"));
  EXPECT_THAT(Succeed({"objects", "show", "wedge"}).out, HasSubstr("2 views"));
  const std::string shown = Succeed({"objects", "show", "wedge", "--json"}).out;
  EXPECT_THAT(shown, HasSubstr("\"name\":\"objects/wedge\""));
  EXPECT_THAT(shown, HasSubstr("\"viewCount\":2"));
  EXPECT_THAT(shown, HasSubstr("\"grasps\":[{"));
  EXPECT_THAT(Graspdb({"objects", "delete", "wedge"}), EndsWith(1));
  Succeed({"objects", "delete", "wedge", "--force"});
  EXPECT_EQ(Status().view_count(), 0);
  EXPECT_THAT(Succeed({"objects", "list"}).out, HasSubstr("the catalogue is empty"));
}

TEST_F(AnswersTest, SetsShowsAndAppliesCells) {
  StartServer();
  EXPECT_THAT(Succeed({"cells", "list"}).out, HasSubstr("there are no cells"));
  Succeed({"cells", "set", "press", "--sensor-pose", "0,-0.5,0.6,-0.8,0,0,0.6", "--region",
           "-0.3,-0.3,-0.02,0.3,0.3,0.4", "--display-name", "Press 3"});
  const std::string shown = Succeed({"cells", "show", "press", "--json"}).out;
  EXPECT_THAT(shown, HasSubstr("\"displayName\":\"Press 3\""));
  EXPECT_THAT(shown, HasSubstr("\"sensorPose\""));
  const std::string file = folder_.Write("cell.json", shown).string();
  Succeed({"cells", "set", "other", "--from", file, "--workspace", "-1,-1,0,1,1,1"});
  EXPECT_THAT(Succeed({"cells", "show", "other", "--json"}).out, HasSubstr("\"workspace\""));
  EXPECT_THAT(Succeed({"cells", "list"}).out, HasSubstr("cells/other"));
  Succeed({"cells", "delete", "other"});
  EXPECT_THAT(Graspdb({"cells", "show", "other"}), EndsWith(1));
}

}  // namespace
}  // namespace graspdb::end_to_end
