// Depth cameras by name.
#include "client/cell/sensors/kinds/open_sensor.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <fstream>
#include <variant>

#include "client/cell/sensors/sensor_spec.h"
#include "files/messages/pose_message.h"
#include "files/points/point_file.h"
#include "rendering/capture_plan.h"
#include "rendering/sample_parts.h"
#include "rendering/scene_file.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;
using ::testing::Pair;
using testing::StatusIs;

TEST(SensorSpec, HasKindTargetAndOptions) {
  const auto spec = ParseSensorSpec("files:/data/a b?loop&rate=5");
  ASSERT_THAT(spec, IsOk());
  EXPECT_EQ(spec->kind, "files");
  EXPECT_EQ(spec->target, "/data/a b");
  EXPECT_THAT(spec->options, ElementsAre(Pair("loop", ""), Pair("rate", "5")));
}

TEST(SensorSpec, AKindAloneIsEnough) {
  const auto spec = ParseSensorSpec("freenect");
  ASSERT_THAT(spec, IsOk());
  EXPECT_EQ(spec->kind, "freenect");
  EXPECT_THAT(spec->target, IsEmpty());
}

TEST(SensorSpec, AKindWithoutATargetMayHaveOptions) {
  const auto spec = ParseSensorSpec("freenect?fx=580.5&fy=580");
  ASSERT_THAT(spec, IsOk());
  EXPECT_EQ(spec->kind, "freenect");
  EXPECT_THAT(spec->target, IsEmpty());
  EXPECT_THAT(spec->options, ElementsAre(Pair("fx", "580.5"), Pair("fy", "580")));
}

TEST(SensorSpec, ASimulationHasOptionsAndNoTarget) {
  const auto spec = ParseSensorSpec("simulated:parts=wedge+handle,seed=7");
  ASSERT_THAT(spec, IsOk());
  EXPECT_THAT(spec->target, IsEmpty());
  EXPECT_THAT(spec->options, ElementsAre(Pair("parts", "wedge+handle"), Pair("seed", "7")));
}

TEST(SensorSpec, UrisAndPathsKeepSpecialCharacters) {
  EXPECT_EQ(ParseSensorSpec("openni2:1d27/0600@1/6")->target, "1d27/0600@1/6");
  EXPECT_EQ(ParseSensorSpec("files:C:/what?/a.pcd")->target, "C:/what?/a.pcd");
  EXPECT_EQ(ParseSensorSpec("files:what?.pcd?loop")->target, "what?.pcd");
}

TEST(SensorSpec, InvalidSpecsAreRejected) {
  EXPECT_THAT(ParseSensorSpec(""), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(ParseSensorSpec(":0"), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(ParseSensorSpec("files:a?loop&loop"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("twice")));
  EXPECT_THAT(ParseSensorSpec("simulated:=7"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("without a key")));
}

TEST(OpenSensor, AnUnknownKindListsTheKnownOnes) {
  EXPECT_THAT(OpenSensor("kinect", {}),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       AllOf(HasSubstr("\"kinect\""), HasSubstr("files"), HasSubstr("simulated"),
                             HasSubstr("freenect"), HasSubstr("openni2"), HasSubstr("freenect2"))));
}

TEST(OpenSensor, AKindThatIsNotBuiltReportsTheMissingLibrary) {
  const auto listing = ListSensors();
  const auto kind = std::find_if(listing.begin(), listing.end(),
                                 [](const SensorListing& k) { return k.kind == "freenect2"; });
  ASSERT_NE(kind, listing.end());
  if (kind->is_built) GTEST_SKIP() << "libfreenect2 is installed here";
  EXPECT_THAT(OpenSensor("freenect2:0123", {}),
              StatusIs(absl::StatusCode::kUnimplemented, HasSubstr("libfreenect2")));
  EXPECT_THAT(OpenSensor("other", {}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("not built")));
}

TEST(OpenSensor, InvalidOptionsAreReported) {
  const files::TemporaryFolder folder;
  const struct {
    std::string spec;
    const char* text;
  } cases[] = {
      {"simulated:sed=7", "\"sed\""},
      {"simulated:seed=x", "seed"},
      {"simulated:camera=v3", "v3"},
      {"simulated:parts=wedge+nothing", "nothing"},
      {"simulated:distance=9", "distance"},
      {"simulated:objects-per-scene=0", "objects-per-scene"},
      {"files:" + folder.path().string() + "?rate=fast", "rate"},
      {"files:" + folder.path().string() + "?loop=maybe", "loop"},
      {"freenect:0?loop", "\"loop\""},
      {"openni2:0?rate=3", "\"rate\""},
      {"openni2:0?loop", "\"loop\""},
      {"simulated:objects-per-scene=2.5", "objects-per-scene"},
      {"freenect?fx=580", "fy"},
      {"freenect:0?fx=580&fy=580&cx=320&cy=tall", "cy"},
      {"openni2?width=320&height=240", "fx"},
      {"push:7110?loop", "\"loop\""},
      {"push:all", "push:7110"},
      {"v4l2", "v4l2:/dev/video2"},
      {"v4l2:/dev/video99?unit=1", "unit"},
      {"v4l2:/dev/video99?fx=400", "fy"},
      {"openni2?width=32.5&fx=580&fy=580&cx=320&cy=240", "width"},
  };
  for (const auto& c : cases) {
    EXPECT_THAT(OpenSensor(c.spec, {}),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(c.text)))
        << c.spec;
  }
}

TEST(OpenSensor, FilesAreOpenedAtOnce) {
  EXPECT_THAT(OpenSensor("files:/no/such/folder", {}), StatusIs(absl::StatusCode::kNotFound));
}

TEST(OpenSensor, PlaysFiles) {
  const files::TemporaryFolder folder;
  ASSERT_THAT(
      files::WritePcd(
          folder.path() / "a.pcd",
          {.points = {{0, 0, 1}}, .normals = {}, .width = 1, .height = 1, .sensor_pose = {}}),
      IsOk());
  const auto sensor = OpenSensor("files:" + folder.path().string() + "?loop", {});
  ASSERT_THAT(sensor, IsOk());
  EXPECT_THAT((*sensor)->Next(MonotonicTime::Now() + absl::Seconds(60)), IsOk());
  EXPECT_TRUE((*sensor)->IsReady());
}

TEST(OpenSensor, NoFrameIsOlderThanTheMaximumAge) {
  SensorSettings settings;
  settings.max_age = absl::Nanoseconds(1);
  settings.intrinsics = {.width = 64, .height = 48, .fx = 46, .fy = 46, .cx = 31.5, .cy = 23.5};
  const auto sensor = OpenSensor("simulated", settings);
  ASSERT_THAT(sensor, IsOk());
  EXPECT_THAT((*sensor)->Next(MonotonicTime::Now() + absl::Seconds(60)),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("old")));
}

TEST(OpenSensor, AMissingCameraIsUnavailableUntilItIsConnected) {
  const auto sensor = OpenSensor("freenect:77", {});
  ASSERT_THAT(sensor, IsOk());
  EXPECT_EQ((*sensor)->Name(), "Kinect v1 (libfreenect) no. 77");
  EXPECT_THAT((*sensor)->Next(MonotonicTime::Now() + absl::Seconds(60)),
              StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_FALSE((*sensor)->IsReady());
}

TEST(OpenSensor, IntrinsicsOfAnotherSizeAreRejectedBeforeOpening) {
  const auto sensor =
      OpenSensor("freenect:77?width=320&height=240&fx=290&fy=290&cx=160&cy=120", {});
  ASSERT_THAT(sensor, IsOk());
  EXPECT_THAT((*sensor)->Next(MonotonicTime::Now() + absl::Seconds(60)),
              StatusIs(absl::StatusCode::kFailedPrecondition,
                       AllOf(HasSubstr("640 x 480"), HasSubstr("320 x 240"))));
}

TEST(OpenSensor, ASimulationShowsAGivenScene) {
  const files::TemporaryFolder folder;
  const auto table = folder.path() / "table";
  SensorSettings settings;
  settings.max_age = absl::Hours(1);
  settings.intrinsics = {.width = 64, .height = 48, .fx = 46, .fy = 46, .cx = 31.5, .cy = 23.5};
  const auto sensor = OpenSensor("simulated:scene=" + table.string(), settings);
  ASSERT_THAT(sensor, IsOk());
  const auto look = [&] { return (*sensor)->Next(MonotonicTime::Now() + absl::Seconds(60)); };
  EXPECT_THAT(look(), StatusIs(absl::StatusCode::kUnavailable));
  const auto plan =
      rendering::PlanRandomScenes(rendering::SampleParts(), {.stand = {}, .count = 2, .seed = 9});
  ASSERT_THAT(plan, IsOk());
  std::vector<std::string> frames;
  for (const rendering::PlannedCapture& scene : *plan) {
    ASSERT_THAT(rendering::WriteScenes(table, rendering::SampleParts(), {scene}), IsOk());
    const auto frame = look();
    ASSERT_THAT(frame, IsOk());
    ASSERT_TRUE(frame->world_sensor);
    EXPECT_TRUE(frame->world_sensor->isApprox(scene.world_sensor, 1e-9));
    frames.push_back(std::get<v1::DepthImage>(frame->scan).data());
    EXPECT_EQ(std::get<v1::DepthImage>(look()->scan).data(), frames.back());
  }
  EXPECT_NE(frames[0], frames[1]);
}

TEST(OpenSensor, AFileHasTheCameraOfADevice) {
  const files::TemporaryFolder folder;
  const std::string file = folder.path() / "d435.json";
  const auto open = [&file](const std::string& text) {
    std::ofstream(file) << text;
    return OpenSensor("v4l2:/dev/video99?intrinsics=" + file, {});
  };
  EXPECT_THAT(OpenSensor("v4l2:/dev/video99?intrinsics=" + file, {}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("d435.json")));
  EXPECT_THAT(open("{\"fx\": 1}"),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("d435.json")));
  const std::string camera =
      R"({"width": 848, "height": 480, "fx": 424, "fy": 424, "cx": 424, "cy": 240)";
  EXPECT_THAT(open(camera + R"(, "k1": 0.1})"),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("distortion")));
  const auto sensor = open(camera + "}");
  ASSERT_THAT(sensor, IsOk());
  EXPECT_THAT((*sensor)->Next(MonotonicTime::Now() + absl::Minutes(1)),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("/dev/video99")));
}

TEST(ListSensors, SaysWhyNothingWasFound) {
  for (const SensorListing& kind : ListSensors()) {
    const bool is_camera = kind.kind != "files" && kind.kind != "simulated" && kind.kind != "push";
    if (!is_camera || !kind.is_built) continue;
    EXPECT_EQ(kind.connected.empty(), !kind.trouble.empty()) << kind.kind;
  }
}

TEST(ListSensors, ListsEveryKindOnce) {
  const auto listing = ListSensors();
  std::vector<std::string> kinds;
  kinds.reserve(listing.size());
  for (const SensorListing& kind : listing) kinds.push_back(kind.kind);
  EXPECT_THAT(kinds, ElementsAre("files", "simulated", "push", "genicam", "v4l2", "freenect",
                                 "openni2", "freenect2"));
  for (const SensorListing& kind : listing) {
    EXPECT_THAT(SensorsText(listing), HasSubstr(kind.kind + ": " + kind.what));
  }
}

}  // namespace
}  // namespace graspdb::client
