#include <gmock/gmock.h>

#include <array>

#include "client/teaching/turntable/view_taking.h"
#include "files/messages/scan_message.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;

constexpr recognition::CameraIntrinsics kCamera = {
    .width = 20, .height = 10, .fx = 100, .fy = 100, .cx = 9.5, .cy = 4.5};

SensorFrame FrameOf(const std::vector<std::uint16_t>& millimetres) {
  SensorFrame frame;
  frame.scan = files::DepthMessage(millimetres, kCamera, 0.001);
  return frame;
}

// The object: columns 5 to 14 of rows 2 to 7.
bool IsObject(std::size_t pixel) {
  const std::size_t column = pixel % 20;
  const std::size_t row = pixel / 20;
  return column >= 5 && column <= 14 && row >= 2 && row <= 7;
}

recognition::Points ObjectPoints() {
  recognition::Points out;
  for (std::size_t i = 0; i < 200; ++i) {
    if (!IsObject(i)) continue;
    const std::size_t row_number = i / 20;
    const auto column = static_cast<float>(i % 20);
    const auto row = static_cast<float>(row_number);
    out.emplace_back(0.8F * (column - 9.5F) / 100, 0.8F * (row - 4.5F) / 100, 0.8F);
  }
  return out;
}

TEST(CaptureQualityOf, AStillObjectIsMeasuredAllOverAndDoesNotMove) {
  const std::array frames = {FrameOf(std::vector<std::uint16_t>(200, 799)),
                             FrameOf(std::vector<std::uint16_t>(200, 801))};
  const auto quality = CaptureQualityOf(frames, ObjectPoints());
  ASSERT_THAT(quality, IsOk());
  EXPECT_EQ(quality->point_count, 60);
  EXPECT_EQ(quality->measured_share, 1);
  EXPECT_EQ(quality->moving_share, 0);
  EXPECT_NEAR(quality->noise_m, 0.001414, 1e-5);
  EXPECT_EQ(CaptureQualityText(*quality),
            "60 points, 100 % of its outline measured, depths within 1.4 mm");
}

TEST(CaptureQualityOf, PixelsWithoutDepthWithinTheOutlineAreHoles) {
  std::vector<std::uint16_t> depth(200, 800);
  recognition::Points object;
  const recognition::Points whole = ObjectPoints();
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (i % 10 < 2 || i % 10 >= 5) object.push_back(whole[i]);  // three of ten in a row are black
  }
  for (std::size_t i = 0; i < 200; ++i) {
    if (IsObject(i) && i % 20 >= 7 && i % 20 < 10) depth[i] = 0;
  }
  const std::array frames = {FrameOf(depth)};
  const auto quality = CaptureQualityOf(frames, object);
  ASSERT_THAT(quality, IsOk());
  EXPECT_NEAR(quality->measured_share, 0.7, 1e-9);
  EXPECT_EQ(quality->noise_m, 0);  // unknown for a single frame
}

TEST(CaptureQualityOf, AnObjectThatIsElsewhereInTheNextFrameMoves) {
  std::vector<std::uint16_t> moved(200, 800);
  for (std::size_t i = 0; i < 200; ++i) {
    if (i % 20 >= 5 && i % 20 < 8) moved[i] = 850;
  }
  const std::array frames = {FrameOf(std::vector<std::uint16_t>(200, 800)), FrameOf(moved)};
  const auto quality = CaptureQualityOf(frames, ObjectPoints());
  ASSERT_THAT(quality, IsOk());
  EXPECT_NEAR(quality->moving_share, 0.3, 1e-9);
}

TEST(CaptureQualityOf, ACloudHasOnlyAPointCount) {
  SensorFrame frame;
  frame.scan = v1::PointCloud();
  const std::array frames = {frame};
  const auto quality = CaptureQualityOf(frames, ObjectPoints());
  ASSERT_THAT(quality, IsOk());
  EXPECT_EQ(CaptureQualityText(*quality), "60 points");
  EXPECT_THAT(CaptureQualityOf({}, {}), StatusIs(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace graspdb::client
