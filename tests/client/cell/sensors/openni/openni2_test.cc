// OpenNI 2: a camera with the tests' own driver, and its recordings, in another process.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "client/cell/sensors/kinds/open_sensor.h"
#include "files/depth/depth_png.h"
#include "files/messages/scan_message.h"
#include "tests/end_to_end/fixtures/process.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using end_to_end::Finished;
using end_to_end::RunProgram;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::IsOk;
using ::testing::Not;
using ::testing::StartsWith;
using testing::StatusIs;

class OpenNi2Test : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(out()); }

  std::filesystem::path out() const { return folder_.path() / "out"; }
  std::string recording() const { return (folder_.path() / "ramp.oni").string(); }

  // Runs a program on the tests' driver; its standard output.
  Finished Run(std::vector<std::string> command, const std::string& variable = "NONE=0") const {
    command.insert(
        command.begin(),
        {"/usr/bin/env", std::string("LD_LIBRARY_PATH=") + GRASPDB_OPENNI2_FOLDER, variable});
    return RunProgram(folder_.path(), command);
  }
  std::vector<std::string> Play(const std::string& spec, int frames,
                                const std::string& variable = "NONE=0") const {
    const Finished finished =
        Run({GRASPDB_PLAYER, spec, out().string(), std::to_string(frames)}, variable);
    EXPECT_LT(finished.exit_status, 2) << finished.out << finished.err;
    return absl::StrSplit(finished.out, '\n');
  }
  void Record(int frames) const {
    const Finished finished = Run({GRASPDB_ONI_RECORDER, recording(), std::to_string(frames)});
    ASSERT_EQ(finished.exit_status, 0) << finished.err;
  }
  // The frame shows the ramp, as it is and not mirrored, with the camera's field of view.
  void ExpectRamp(int number) const {
    const auto camera = files::ReadIntrinsics(out() / files::kIntrinsicsFile);
    ASSERT_THAT(camera, IsOk());
    EXPECT_NEAR(camera->intrinsics.fx, 320 / std::tan(0.5), 1e-3);
    EXPECT_NEAR(camera->intrinsics.fy, 240 / std::tan(0.375), 1e-3);
    EXPECT_EQ(camera->depth_unit_m, 0.001);
    const auto image = files::ReadDepthPng(out() / (std::to_string(number) + ".png"), *camera);
    ASSERT_THAT(image, IsOk());
    const auto counts = *files::CountsFromMessage(*image);
    for (std::size_t i = 0; i < counts.size(); ++i) ASSERT_EQ(counts[i], 500 + i % 640) << i;
  }

 private:
  const files::TemporaryFolder folder_;
};

TEST_F(OpenNi2Test, DepthsAreNotMirrored) {
  EXPECT_THAT(Play("openni2:Test/Ramp", 2), Contains("frame 1"));
  ExpectRamp(0);
  ExpectRamp(1);
}

TEST_F(OpenNi2Test, OpensAnyCamera) { EXPECT_THAT(Play("openni2", 1), Contains("frame 0")); }

TEST_F(OpenNi2Test, ReconnectsAnUnpluggedCamera) {
  // Fewer than are read, so that it is unplugged before they all are.
  const auto lines = Play("openni2:Test/Ramp", 12, "GRASPDB_TEST_CAMERA_FRAMES=11");
  EXPECT_THAT(lines, Contains(AllOf(StartsWith("error UNAVAILABLE"), HasSubstr("was unplugged"))));
  EXPECT_THAT(lines, Contains("frame 11"));
  EXPECT_THAT(lines, Not(Contains(HasSubstr("event=")))) << "the log may be between any two words";
}

TEST_F(OpenNi2Test, UnpluggingAnotherCameraHasNoEffect) {
  const auto lines = Play("openni2", 20, "GRASPDB_TEST_OTHER_CAMERA_FRAMES=10");
  EXPECT_THAT(lines, Contains("frame 19"));
  EXPECT_THAT(lines, Not(Contains(StartsWith("error"))));
}

TEST_F(OpenNi2Test, IntrinsicsMayBeGiven) {
  EXPECT_THAT(Play("openni2:Test/Ramp?fx=501.5&fy=502&cx=319&cy=239", 1), Contains("frame 0"));
  const auto camera = files::ReadIntrinsics(out() / files::kIntrinsicsFile);
  ASSERT_THAT(camera, IsOk());
  EXPECT_EQ(camera->intrinsics.fx, 501.5);
  EXPECT_EQ(camera->intrinsics.cy, 239);
  EXPECT_EQ(camera->intrinsics.width, 640);
}

TEST_F(OpenNi2Test, IntrinsicsOfAnotherSizeAreRejected) {
  EXPECT_THAT(Play("openni2:Test/Ramp?width=320&height=240&fx=250&fy=250&cx=160&cy=120", 1),
              Contains(AllOf(StartsWith("error FAILED_PRECONDITION"), HasSubstr("320 x 240"))));
}

TEST_F(OpenNi2Test, AMissingCameraIsReported) {
  EXPECT_THAT(Play("openni2:Test/Other", 1),
              Contains(AllOf(StartsWith("error UNAVAILABLE: OpenNI 2 camera Test/Other"),
                             HasSubstr("cannot be opened"))));
}

TEST_F(OpenNi2Test, PlaysARecordingToItsEnd) {
  Record(40);
  const auto lines = Play("openni2:" + recording(), 1000);
  EXPECT_THAT(lines, Contains("frame 0"));
  ExpectRamp(0);
  EXPECT_THAT(lines, Contains(AllOf(StartsWith("error UNAVAILABLE"), HasSubstr("at its end"))));
  EXPECT_THAT(lines, Contains("ready 0"));
}

TEST_F(OpenNi2Test, ARecordingLoopsIfSet) {
  Record(10);
  EXPECT_THAT(Play("openni2:" + recording() + "?loop", 25), Contains("frame 24"));
}

TEST(OpenNi2, MissingAndInvalidRecordingsAreRejected) {
  const files::TemporaryFolder folder;
  EXPECT_THAT(OpenSensor("openni2:" + (folder.path() / "none.oni").string(), {}),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("none.oni")));
  EXPECT_THAT(OpenSensor("openni2:" + folder.Write("bad.oni", "rubbish").string(), {}),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("bad.oni")));
}

}  // namespace
}  // namespace graspdb::client
