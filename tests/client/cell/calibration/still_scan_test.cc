#include "client/cell/calibration/target/still_scan.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <vector>

#include "files/messages/scan_message.h"
#include "tests/client/cell/agent/fake_camera.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;

constexpr recognition::CameraIntrinsics kCamera = {
    .width = 3, .height = 2, .fx = 100, .fy = 50, .cx = 1, .cy = 0.5};

SensorFrame FrameOf(const std::vector<std::uint16_t>& counts) {
  SensorFrame frame;
  frame.scan = files::DepthMessage(counts, kCamera, 0.001);
  return frame;
}

// Six pixels, of which the first is of interest.
SensorFrame First(std::uint16_t count) { return FrameOf({count, 800, 800, 800, 800, 800}); }

float DepthOfFirst(const std::vector<SensorFrame>& frames) {
  const auto scan = Averaged(frames);
  EXPECT_THAT(scan, IsOk());
  return scan.ok() ? scan->points.front().z() : -1;
}

TEST(ScanOf, AnImageHasItsCamera) {
  const auto scan = ScanOf(FrameOf({500, 0, 0, 0, 0, 1000}));
  ASSERT_THAT(scan, IsOk());
  EXPECT_EQ(scan->width, 3);
  EXPECT_EQ(scan->camera, kCamera);
  ASSERT_EQ(scan->points.size(), 6U);
  EXPECT_TRUE(scan->points[5].isApprox(Eigen::Vector3f(0.01F, 0.01F, 1), 1e-5F));
}

TEST(ScanOf, AnInvalidImageIsRejected) {
  SensorFrame frame = First(800);
  std::get<v1::DepthImage>(frame.scan).mutable_data()->pop_back();
  EXPECT_THAT(ScanOf(frame), StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST(Averaged, NoiseIsAveraged) {
  EXPECT_NEAR(DepthOfFirst({First(798), First(800), First(803), First(801)}), 0.8005, 1e-6);
}

TEST(Averaged, PixelsMeasuredInFewerThanHalfOfTheFramesAreNaN) {
  EXPECT_NEAR(DepthOfFirst({First(800), First(0), First(802), First(0)}), 0.801, 1e-6);
  EXPECT_TRUE(std::isnan(DepthOfFirst({First(800), First(0), First(0), First(0)})));
  EXPECT_TRUE(std::isnan(DepthOfFirst({First(800), First(802), First(0), First(0), First(0)})));
}

TEST(Averaged, FlyingPixelsAreLeftOut) {
  EXPECT_NEAR(DepthOfFirst({First(800), First(950), First(802)}), 0.801, 1e-6);
}

TEST(Averaged, ReturnsTheLastOfIncompatibleFrames) {
  SensorFrame smaller;
  recognition::CameraIntrinsics camera = kCamera;
  camera.height = 1;
  smaller.scan = files::DepthMessage({700, 700, 700}, camera, 0.001);
  const auto scan = Averaged(std::array{First(800), smaller});
  ASSERT_THAT(scan, IsOk());
  EXPECT_EQ(scan->points.size(), 3U);
  SensorFrame loose;  // not organised
  loose.scan = files::CloudMessage({{0, 0, 0.9F}}, 0);
  const auto last = Averaged(std::array{loose, loose});
  ASSERT_THAT(last, IsOk());
  EXPECT_EQ(last->points.size(), 1U);
  EXPECT_FALSE(last->camera);
  EXPECT_THAT(Averaged({}), StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST(TakeStillScan, TakesTheNumberOfFramesAndReturnsTheSensorsError) {
  FakeCamera camera([] { return First(800); });
  EXPECT_THAT(TakeStillScan(camera, 3, MonotonicTime::InfiniteFuture()), IsOk());
  EXPECT_EQ(camera.calls, 3);
  FakeCamera unplugged(
      []() -> absl::StatusOr<SensorFrame> { return absl::UnavailableError("unplugged"); });
  EXPECT_THAT(TakeStillScan(unplugged, 3, MonotonicTime::InfiniteFuture()),
              StatusIs(absl::StatusCode::kUnavailable));
}

TEST(AwaitFrames, EndsWhenTheSensorIsReadyOrTheTimeIsUp) {
  FakeCamera camera([] { return First(800); });
  AwaitFrames(camera, MonotonicTime::InfiniteFuture());
  camera.ready = false;
  const MonotonicTime deadline = MonotonicTime::Now() + absl::Milliseconds(30);
  AwaitFrames(camera, deadline);
  EXPECT_GE(MonotonicTime::Now(), deadline);
  EXPECT_EQ(camera.calls, 0);
}

}  // namespace
}  // namespace graspdb::client
