// The simulated camera as a sensor.
#include "client/cell/sensors/simulated/simulated_sensor.h"

#include <gmock/gmock.h>

#include "files/messages/scan_message.h"
#include "rendering/sample_parts.h"
#include "rendering/simulation.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using testing::IsOk;
using testing::StatusIs;

rendering::DepthCameraModel SmallCamera() {
  rendering::DepthCameraModel camera = rendering::KinectV2();
  camera.intrinsics = {.width = 64, .height = 48, .fx = 46, .fy = 46, .cx = 31.5, .cy = 23.5};
  return camera;
}

std::unique_ptr<SimulatedSensor> SensorOf(SceneSource scenes) {
  auto sensor = SimulatedSensor::Create(SmallCamera(), rendering::SampleParts(), std::move(scenes));
  EXPECT_THAT(sensor, IsOk());
  return sensor.ok() ? *std::move(sensor) : nullptr;
}

std::string NextData(SimulatedSensor& sensor) {
  const auto frame = sensor.Next(MonotonicTime::InfiniteFuture());
  EXPECT_THAT(frame, IsOk());
  return frame.ok() ? std::get<v1::DepthImage>(frame->scan).data() : "";
}

rendering::PlannedCapture SceneOfOne() {
  return {.path = "",
          .placements = {{.part = 2}},
          .world_sensor = rendering::LookAt(Eigen::Vector3d::Zero(), 0.8, 40, -90)};
}

// The same scene at every call, with other noise.
SceneSource StillScene(rendering::PlannedCapture scene) {
  return [scene = std::move(scene)]() mutable {
    ++scene.seed;
    return absl::StatusOr<rendering::PlannedCapture>(scene);
  };
}

// The expected frame of a scene.
std::string DataOf(const rendering::PlannedCapture& scene) {
  const auto camera = rendering::DepthCamera::Create(SmallCamera());
  EXPECT_THAT(camera, IsOk());
  const std::vector<rendering::Workpiece> parts = rendering::SampleParts();
  const auto frame = camera->Render(rendering::SceneOf(parts, scene, /*with_table=*/true),
                                    scene.world_sensor, scene.seed);
  EXPECT_THAT(frame, IsOk());
  return files::DepthMessage(rendering::ToCounts(*frame, 0.001), SmallCamera().intrinsics, 0.001)
      .data();
}

TEST(SimulatedSensor, ShowsRandomScenesWithTheSensorPose) {
  rendering::RandomSceneOptions options;
  options.seed = 5;
  options.count = 3;
  const auto plan = rendering::PlanRandomScenes(rendering::SampleParts(), options);
  ASSERT_THAT(plan, IsOk());
  const auto sensor = SensorOf(RandomScenes(rendering::SampleParts(), options));
  for (const rendering::PlannedCapture& expected : *plan) {
    const auto frame = sensor->Next(MonotonicTime::InfiniteFuture());
    ASSERT_THAT(frame, IsOk());
    EXPECT_EQ(std::get<v1::DepthImage>(frame->scan).data(), DataOf(expected));
    ASSERT_TRUE(frame->world_sensor.has_value());
    EXPECT_TRUE(frame->world_sensor->isApprox(expected.world_sensor, 1e-12));
  }
}

TEST(SimulatedSensor, RandomScenesAreUnlimited) {
  const SceneSource scenes = RandomScenes(rendering::SampleParts(), {});
  rendering::RandomSceneOptions many;
  many.count = 100;
  const auto plan = rendering::PlanRandomScenes(rendering::SampleParts(), many);
  ASSERT_THAT(plan, IsOk());
  for (const rendering::PlannedCapture& expected : *plan) {
    const auto scene = scenes();
    ASSERT_THAT(scene, IsOk());
    EXPECT_EQ(scene->path, expected.path);
    EXPECT_EQ(scene->seed, expected.seed);
  }
}

TEST(SimulatedSensor, EveryFrameHasNewNoise) {
  const auto one = SensorOf(StillScene(SceneOfOne()));
  const auto other = SensorOf(StillScene(SceneOfOne()));
  const std::string first = NextData(*one);
  EXPECT_EQ(NextData(*other), first);
  EXPECT_NE(NextData(*one), first);
}

TEST(SimulatedSensor, MeasuresTheTableInMillimetres) {
  const auto sensor = SensorOf(StillScene(SceneOfOne()));
  const auto frame = sensor->Next(MonotonicTime::InfiniteFuture());
  ASSERT_THAT(frame, IsOk());
  const auto& image = std::get<v1::DepthImage>(frame->scan);
  const auto counts = files::CountsFromMessage(image);
  ASSERT_THAT(counts, IsOk());
  // In the middle is the part, or the table 0.8 m away.
  EXPECT_NEAR(files::DepthUnit(image) * (*counts)[24 * 64 + 32], 0.75, 0.08);
}

TEST(SimulatedSensor, TheSourceMaySimulateAnUnpluggedCamera) {
  const auto sensor = SensorOf([] {
    return absl::StatusOr<rendering::PlannedCapture>(absl::UnavailableError("pulled out"));
  });
  EXPECT_THAT(sensor->Next(MonotonicTime::InfiniteFuture()),
              StatusIs(absl::StatusCode::kUnavailable, "pulled out"));
}

TEST(SimulatedSensor, AnUnknownWorkpieceIsRejected) {
  rendering::PlannedCapture scene = SceneOfOne();
  scene.placements[0].part = 99;
  const auto sensor = SensorOf(StillScene(scene));
  EXPECT_THAT(sensor->Next(MonotonicTime::InfiniteFuture()),
              StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST(SimulatedSensor, ADeadlineInThePastIsExceeded) {
  const auto sensor = SensorOf(StillScene(SceneOfOne()));
  EXPECT_THAT(sensor->Next(MonotonicTime::InfinitePast()),
              StatusIs(absl::StatusCode::kDeadlineExceeded));
}

}  // namespace
}  // namespace graspdb::client
