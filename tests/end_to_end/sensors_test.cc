// Commands with a depth camera, as processes: connected cameras, recordings, and missing cameras.
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <thread>

#include "files/points/point_file.h"
#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;
using ::testing::Not;

// More cameras than any machine has.
constexpr char kNoCamera[] = "freenect:77";

class SensorsTest : public ProgramsTest {
 protected:
  // A folder with one frame.
  std::string WriteFrame() const {
    EXPECT_THAT(
        files::WritePcd(folder_.path() / "played" / "a.pcd", {.points = {{0, 0, 1}, {0, 0.1F, 1}},
                                                              .normals = {},
                                                              .width = 2,
                                                              .height = 1,
                                                              .sensor_pose = {}}),
        IsOk());
    return "files:" + Path("played");
  }
};

class CalibrationProgramsTest : public SensorsTest {
 protected:
  void SetUp() override { StartServer(); }
  // The number behind a key of a line of JSON.
  static double NumberOf(const std::string& json, const std::string& key) {
    const std::size_t at = json.find("\"" + key + "\":");
    EXPECT_NE(at, std::string::npos) << json;
    return at == std::string::npos ? NAN : std::stod(json.substr(at + key.size() + 3));
  }
};

// The simulated camera is 0.8 m from the origin and looks down by 40 degrees.
TEST_F(CalibrationProgramsTest, LevelsAndChecksACamera) {
  const Finished levelled = Succeed({"cells", "level", "press", "--sensor", "simulated"});
  EXPECT_THAT(levelled.out, HasSubstr("camera 51"));
  EXPECT_THAT(Succeed({"cells", "show", "press", "--json"}).out, HasSubstr("\"sensorPose\""));
  const Finished checked = Succeed({"cells", "check", "press", "--sensor", "simulated:seed=8"});
  EXPECT_THAT(checked.out, HasSubstr("mm from z = 0, tilted by 0."));
  Succeed({"sensors", "grab", "simulated:seed=9", "--out", Path("look")});
  const Finished json =
      Succeed({"cells", "check", "press", "--sensor", "files:" + Path("look") + "?loop", "--json"});
  EXPECT_EQ(CountLines(json.out), 1);
  EXPECT_LT(std::abs(NumberOf(json.out, "height_mm")), 2);
  EXPECT_LT(NumberOf(json.out, "tilt_deg"), 0.5);
  EXPECT_GT(NumberOf(json.out, "share"), 0.5);
}

TEST_F(CalibrationProgramsTest, ReportsFailedChecks) {
  Succeed({"cells", "set", "press"});
  const Finished fresh = Graspdb({"cells", "check", "press", "--sensor", "simulated"});
  EXPECT_THAT(fresh, EndsWith(1));
  EXPECT_THAT(fresh, PrintsOnly("graspdb", "cells level"));
  Succeed({"cells", "set", "arm", "--flange-sensor-pose", "0,0,0.1,0,0,0,1"});
  const Finished flange = Graspdb({"cells", "check", "arm", "--sensor", "simulated"});
  EXPECT_THAT(flange, EndsWith(1));
  EXPECT_THAT(flange, PrintsOnly("graspdb", "--poses"));
  EXPECT_THAT(flange.err, Not(HasSubstr("cells level")));
  EXPECT_THAT(Graspdb({"cells", "check", "press"}), PrintsOnly("graspdb", "--frame"));
}

TEST_F(SensorsTest, ListsKinds) {
  const Finished text = Succeed({"sensors", "list"});
  EXPECT_THAT(text.out, AllOf(HasSubstr("files: "), HasSubstr("freenect: ")));
  EXPECT_THAT(Succeed({"sensors", "list", "--json"}).out, HasSubstr("\"kind\":\"freenect\""));
}

TEST_F(SensorsTest, PlaysGrabbedFrames) {
  const Finished json = Succeed({"sensors", "grab", "simulated", "--out", Path("json"), "--json"});
  EXPECT_EQ(json.out,
            "{\"file\":\"" + Path("json/0000.png") + "\",\"sensor\":\"simulated camera\"}\n");
  const Finished grabbed =
      Succeed({"sensors", "grab", "simulated", "--frames", "2", "--out", Path("look")});
  EXPECT_EQ(CountLines(grabbed.out), 2);
  const Finished again =
      Succeed({"sensors", "grab", "files:" + Path("look"), "--frames", "2", "--out", Path("copy")});
  EXPECT_THAT(again.out, HasSubstr("0001.png"));
  EXPECT_EQ(files::BytesOf(Path("copy/0001.png")), files::BytesOf(Path("look/0001.png")));
}

TEST_F(SensorsTest, PrintsARecordingForFakenectAsJson) {
  const Finished written = Succeed(
      {"sensors", "fakenect", "--out", Path("kinect"), "--scenes", "1", "--hold", "0.1", "--json"});
  EXPECT_EQ(written.out, "{\"folder\":\"" + Path("kinect") + "\",\"hold_s\":0.1,\"scenes\":1}\n");
}

TEST_F(SensorsTest, EndsAtTheEndOfARecording) {
  const Finished grabbed = Graspdb(
      {"sensors", "grab", WriteFrame(), "--frames", "2", "--wait", "3600", "--out", Path("look")});
  EXPECT_THAT(grabbed, EndsWith(1));
  EXPECT_EQ(CountLines(grabbed.out), 1);
  EXPECT_THAT(grabbed, PrintsOnly("graspdb", "add ?loop"));
}

TEST_F(SensorsTest, FailsAnInterruptedGrab) {
  const auto grab = StartGraspdb({"sensors", "grab", WriteFrame() + "?loop&rate=20", "--frames",
                                  "1000000", "--out", Path("look")});
  while (!std::filesystem::exists(Path("look/0001.pcd")) && grab->Errors().empty()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  grab->Signal(SIGINT);
  const Finished ended = grab->Wait();
  EXPECT_THAT(ended, EndsWith(1));
  EXPECT_THAT(ended, PrintsOnly("graspdb", "of 1000000 frames"));
}

TEST_F(SensorsTest, DoesNotReportAMissingCameraAsAMissingServer) {
  const Finished grab =
      Graspdb({"sensors", "grab", kNoCamera, "--wait", "0.1", "--out", Path("look")});
  EXPECT_THAT(grab, EndsWith(1));
  EXPECT_THAT(grab.out, IsEmpty());
  EXPECT_THAT(grab, PrintsOnly("graspdb", "no. 77"));

  StartServer();
  Succeed({"cells", "set", "press", "--sensor-pose", "0,-0.5,0.6,-0.891,0,0,0.454", "--region",
           "-0.3,-0.3,-0.02,0.3,0.3,0.4"});
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"cells", "level", "press", "--sensor", kNoCamera, "--json"},
        std::vector<std::string>{"teach", "mug", "--sensor", kNoCamera, "--cell", "press",
                                 "--json"}}) {
    const Finished none = Graspdb(words);
    EXPECT_THAT(none, EndsWith(1)) << words[0];
    EXPECT_THAT(none.out, IsEmpty()) << "stdout is for answers only";
    EXPECT_THAT(none.err, HasSubstr("no. 77"));
    EXPECT_THAT(none.err, Not(HasSubstr("start graspdb-server")));
  }
}

}  // namespace
}  // namespace graspdb::end_to_end
