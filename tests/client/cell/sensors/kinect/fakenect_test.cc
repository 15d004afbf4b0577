// The first Kinect through the real libfreenect interface: fakenect plays recordings to another
// process.
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "client/cell/sensors/kinect/fakenect_recording.h"
#include "client/cell/sensors/kinect/kinect_v1_calibration.h"
#include "files/capture_sets/capture_set.h"
#include "files/depth/depth_png.h"
#include "files/messages/scan_message.h"
#include "rendering/sample_parts.h"
#include "tests/end_to_end/fixtures/process.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using end_to_end::RunProgram;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::IsOk;
using ::testing::StartsWith;
using testing::StatusIs;

constexpr absl::Duration kLongEnough = absl::Milliseconds(500);

// A plane of one depth before the camera.
rendering::DepthFrame Plane(float depth_m) {
  return {.width = kKinectV1Width,
          .height = kKinectV1Height,
          .depth_m = std::vector<float>(std::size_t{kKinectV1Width} * kKinectV1Height, depth_m),
          .surface = {}};
}

class FakenectTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::string(GRASPDB_FAKENECT_LIBRARY).empty()) {
      GTEST_SKIP() << "libfreenect came without fakenect; install Debian's libfreenect-dev";
    }
    std::filesystem::create_directories(out());
  }

  std::filesystem::path recording() const { return folder_.path() / "recording"; }
  std::filesystem::path out() const { return folder_.path() / "out"; }

  // Lines of the player's output.
  std::vector<std::string> Play(int frames, const std::filesystem::path& played) const {
    const std::string library =
        std::filesystem::path(GRASPDB_FAKENECT_LIBRARY).parent_path().string();
    const auto finished = RunProgram(
        folder_.path(),
        {"/usr/bin/env", "LD_LIBRARY_PATH=" + library, "FAKENECT_PATH=" + played.string(),
         "FAKENECT_LOOP=0", GRASPDB_PLAYER, "freenect:0", out().string(), std::to_string(frames)});
    EXPECT_LT(finished.exit_status, 2) << finished.out << finished.err;
    return absl::StrSplit(finished.out, '\n');
  }

  std::vector<std::uint16_t> Played(int number) const {
    const auto camera = files::ReadIntrinsics(out() / files::kIntrinsicsFile);
    EXPECT_THAT(camera, IsOk());
    const auto image = files::ReadDepthPng(out() / (std::to_string(number) + ".png"), *camera);
    EXPECT_THAT(image, IsOk());
    return image.ok() ? *files::CountsFromMessage(*image) : std::vector<std::uint16_t>();
  }

  const files::TemporaryFolder folder_;
};

TEST_F(FakenectTest, MeasuresTheSimulatedDepths) {
  const auto parts = rendering::SampleParts();
  const auto camera = rendering::DepthCamera::Create(SimulatedKinectV1());
  ASSERT_THAT(camera, IsOk());
  const rendering::Scene scene = {.objects = {{.mesh = &parts[0].mesh}}};
  const auto seen =
      camera->Render(scene, rendering::LookAt(Eigen::Vector3d::Zero(), 0.8, 40, -90), /*seed=*/3);
  ASSERT_THAT(seen, IsOk());
  auto writer = FakenectRecording::Create(recording());
  ASSERT_THAT(writer, IsOk());
  ASSERT_THAT(writer->Show(*seen, kLongEnough), IsOk());
  ASSERT_THAT(writer->Finish(), IsOk());

  EXPECT_THAT(Play(1, recording()), Contains("frame 0"));
  const std::vector<std::uint16_t> played = Played(0);
  ASSERT_EQ(played.size(), seen->depth_m.size());
  int measured = 0;
  for (std::size_t i = 0; i < played.size(); ++i) {
    const double truth = static_cast<double>(seen->depth_m[i]);
    ASSERT_EQ(played[i] == 0, truth == 0) << i;
    measured += truth == 0 ? 0 : 1;
    // Half a step of the disparity: dz = z^2 / (focal length of the sensor * baseline) / 4 / 2.
    const double step_m = truth * truth / (1.2 / 0.001042 * 0.075) / 4;
    ASSERT_NEAR(played[i] * kKinectV1DepthUnitM, truth, step_m / 2 + kKinectV1DepthUnitM) << i;
  }
  EXPECT_GT(measured, 200'000);
  const auto k = files::ReadIntrinsics(out() / files::kIntrinsicsFile);
  EXPECT_NEAR(k->intrinsics.fx, camera->model().intrinsics.fx, 1e-9);
}

TEST_F(FakenectTest, ARecordingOfRandomScenesMatchesItsGroundTruth) {
  const auto parts = rendering::SampleParts();
  const auto plan = rendering::PlanRandomScenes(parts, {.stand = {}, .count = 2, .seed = 4});
  ASSERT_THAT(plan, IsOk());
  ASSERT_THAT(WriteSimulatedRecording(recording(), parts, *plan, kLongEnough), IsOk());
  EXPECT_THAT(Play(1, recording()), Contains("frame 0"));
  const auto loaded = files::LoadCaptureSet(recording());
  ASSERT_THAT(loaded, IsOk());
  const v1::CaptureSet& truth = *loaded;
  ASSERT_EQ(truth.captures_size(), 2);
  EXPECT_EQ(truth.captures(1).object_id(), parts[(*plan)[1].placements[0].part].object_id);
  EXPECT_TRUE(truth.captures(1).has_sensor_pose());
}

TEST_F(FakenectTest, TheEndOfARecordingLooksLikeAnUnpluggedCamera) {
  auto writer = FakenectRecording::Create(recording());
  ASSERT_THAT(writer, IsOk());
  ASSERT_THAT(writer->Show(Plane(0.7F), kLongEnough), IsOk());
  ASSERT_THAT(writer->Finish(), IsOk());
  const auto lines = Play(1000, recording());
  EXPECT_THAT(lines, Contains("frame 0"));
  EXPECT_THAT(lines, Contains(StartsWith("error UNAVAILABLE: Kinect v1 (libfreenect) no. 0 was "
                                         "unplugged")));
  EXPECT_THAT(lines, Contains("ready 0"));
}

TEST_F(FakenectTest, ReconnectsAnUnpluggedCamera) {
  auto writer = FakenectRecording::Create(recording());
  ASSERT_THAT(writer, IsOk());
  ASSERT_THAT(writer->Show(Plane(0.6F), kLongEnough), IsOk());
  ASSERT_THAT(writer->PullOut(), IsOk());
  ASSERT_THAT(writer->Show(Plane(1.1F), kLongEnough), IsOk());
  ASSERT_THAT(writer->Finish(), IsOk());
  const auto lines = Play(1000, recording());
  EXPECT_THAT(lines, Contains(HasSubstr("was unplugged")));
  int last = -1;
  while (std::filesystem::exists(out() / (std::to_string(last + 1) + ".png"))) ++last;
  ASSERT_GE(last, 1);
  EXPECT_NEAR(Played(0)[1000] * kKinectV1DepthUnitM, 0.6, 0.001);
  EXPECT_NEAR(Played(last)[1000] * kKinectV1DepthUnitM, 1.1, 0.003);
}

TEST_F(FakenectTest, AMissingRecordingIsAnErrorNotAnExit) {
  const auto lines = Play(1, folder_.path() / "none");
  EXPECT_THAT(lines,
              Contains(AllOf(StartsWith("error FAILED_PRECONDITION"), HasSubstr("FAKENECT_PATH"))));
  EXPECT_THAT(lines, Contains("ready 0"));
}

TEST(FakenectRecording, IsNotOverwritten) {
  const files::TemporaryFolder folder;
  auto writer = FakenectRecording::Create(folder.path());
  ASSERT_THAT(writer, IsOk());
  ASSERT_THAT(writer->Finish(), IsOk());
  EXPECT_THAT(FakenectRecording::Create(folder.path()), StatusIs(absl::StatusCode::kAlreadyExists));
}

TEST(FakenectRecording, HasTheFormatOfFakenectRecord) {
  const files::TemporaryFolder folder;
  auto writer = FakenectRecording::Create(folder.path());
  ASSERT_THAT(writer, IsOk());
  ASSERT_THAT(writer->Show(Plane(1.2F), absl::Milliseconds(100)), IsOk());
  ASSERT_THAT(writer->Finish(), IsOk());
  EXPECT_EQ(files::BytesOf(folder.path() / "INDEX.txt"),
            "d-1000000.000000-0.pgm\nd-1000000.033333-2000000.pgm\nd-1000000.066667-4000000.pgm\n");
  const std::string frame = files::BytesOf(folder.path() / "d-1000000.033333-2000000.pgm");
  EXPECT_THAT(frame, StartsWith("P5 640 480 65535\n"));
  ASSERT_EQ(frame.size(), 17U + 2U * 640 * 480);
  EXPECT_NEAR(static_cast<unsigned char>(frame[17]) + 256 * frame[18], 801.5, 0.51);
  EXPECT_THAT(files::BytesOf(folder.path() / "device.json"), HasSubstr("\"reference_distance\""));
}

TEST(FakenectRecording, RejectsFramesOfOtherSizes) {
  const files::TemporaryFolder folder;
  auto writer = FakenectRecording::Create(folder.path());
  ASSERT_THAT(writer, IsOk());
  EXPECT_THAT(
      writer->Show({.width = 2, .height = 1, .depth_m = {1, 1}, .surface = {}}, kLongEnough),
      StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("SimulatedKinectV1")));
  EXPECT_THAT(writer->ShowRaw({1, 2, 3}, kLongEnough),
              StatusIs(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace graspdb::client
