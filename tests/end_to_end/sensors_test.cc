// Commands with a depth camera, as processes: cameras that are there, play files, or are not there.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "client/files/point_file.h"
#include "tests/end_to_end/outcome_matchers.h"
#include "tests/end_to_end/programs_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;
using ::testing::Not;

// No machine has so many.
constexpr char kNoCamera[] = "freenect:77";

class SensorsTest : public ProgramsTest {
 protected:
  // A folder with one frame.
  std::string WriteFrame() const {
    EXPECT_THAT(
        client::WritePcd(folder_.path() / "played" / "a.pcd", {.points = {{0, 0, 1}, {0, 0.1F, 1}},
                                                               .normals = {},
                                                               .width = 2,
                                                               .height = 1,
                                                               .sensor_pose = {}}),
        IsOk());
    return "files:" + Path("played");
  }
};

TEST_F(SensorsTest, KindsAreListed) {
  const Finished text = Succeed({"sensors", "list"});
  EXPECT_THAT(text.out, AllOf(HasSubstr("files: "), HasSubstr("freenect: ")));
  EXPECT_THAT(Succeed({"sensors", "list", "--json"}).out, HasSubstr("\"kind\":\"freenect\""));
}

TEST_F(SensorsTest, WhatWasGrabbedIsPlayed) {
  const Finished grabbed =
      Succeed({"sensors", "grab", "simulated", "--frames", "2", "--out", Path("look")});
  EXPECT_EQ(CountLines(grabbed.out), 2);
  const Finished again =
      Succeed({"sensors", "grab", "files:" + Path("look"), "--frames", "2", "--out", Path("copy")});
  EXPECT_THAT(again.out, HasSubstr("0001.png"));
  EXPECT_EQ(client::BytesOf(Path("copy/0001.png")), client::BytesOf(Path("look/0001.png")));
}

TEST_F(SensorsTest, NobodyWaitsForMoreThanARecordingHas) {
  const Finished grabbed = Graspdb(
      {"sensors", "grab", WriteFrame(), "--frames", "2", "--wait", "3600", "--out", Path("look")});
  EXPECT_THAT(grabbed, EndsWith(1));
  EXPECT_EQ(CountLines(grabbed.out), 1);
  EXPECT_THAT(grabbed, SaysOnly("graspdb", "add ?loop"));
}

TEST_F(SensorsTest, AGrabThatWasInterruptedIsNotDone) {
  const auto grab = StartGraspdb({"sensors", "grab", WriteFrame() + "?loop&rate=20", "--frames",
                                  "1000000", "--out", Path("look")});
  while (!std::filesystem::exists(Path("look/0001.pcd")) && grab->Errors().empty()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  grab->Signal(SIGINT);
  const Finished ended = grab->Wait();
  EXPECT_THAT(ended, EndsWith(1));
  EXPECT_THAT(ended, SaysOnly("graspdb", "of 1000000 frames"));
}

TEST_F(SensorsTest, ACameraThatIsNotThereIsNoMissingServer) {
  const Finished grab =
      Graspdb({"sensors", "grab", kNoCamera, "--wait", "0.1", "--out", Path("look")});
  EXPECT_THAT(grab, EndsWith(1));
  EXPECT_THAT(grab.out, IsEmpty());
  EXPECT_THAT(grab, SaysOnly("graspdb", "no. 77"));

  StartServer();
  Succeed({"cells", "set", "press", "--sensor-pose", "0,-0.5,0.6,-0.891,0,0,0.454", "--region",
           "-0.3,-0.3,-0.02,0.3,0.3,0.4"});
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"cells", "level", "press", "--sensor", kNoCamera, "--json"},
        std::vector<std::string>{"teach", "mug", "--sensor", kNoCamera, "--cell", "press",
                                 "--json"}}) {
    const Finished none = Graspdb(words);
    EXPECT_THAT(none, EndsWith(1)) << words[0];
    EXPECT_THAT(none.out, IsEmpty()) << "nothing but answers belongs there";
    EXPECT_THAT(none.err, HasSubstr("no. 77"));
    EXPECT_THAT(none.err, Not(HasSubstr("start graspdb-server")));
  }
}

}  // namespace
}  // namespace graspdb::end_to_end
