#include "recognition/verification/depth_buffer.h"

#include <gtest/gtest.h>

#include <cmath>

namespace graspdb::recognition {
namespace {

// Around the image's middle, 1 m before the sensor: a plate of 10 cm (the segment) on a wall.
class DepthBufferTest : public ::testing::Test {
 protected:
  static constexpr float kPitchM = 0.002F;

  // Measures points in the strip `from_m` <= x < `to_m` that are not on the plate.
  void See(float from_m, float to_m, float depth_m) {
    for (float x = from_m; x < to_m; x += kPitchM) {
      for (float y = -0.1F; y < 0.1F; y += kPitchM) {
        if (std::abs(x) < 0.05F && std::abs(y) < 0.05F) continue;
        scan_.points.emplace_back(x * depth_m, y * depth_m, depth_m);
      }
    }
  }

  DepthBuffer Look() {
    for (float x = -0.05F; x < 0.05F; x += kPitchM) {
      for (float y = -0.05F; y < 0.05F; y += kPitchM) {
        segment_.indices.push_back(static_cast<std::int32_t>(scan_.points.size()));
        scan_.points.emplace_back(x, y, 1.0F);
        segment_.cloud.points.emplace_back(x, y, 1.0F);
      }
    }
    return {scan_, Pose::Identity(), segment_};
  }

  Scan scan_;
  Segment segment_;
};

TEST_F(DepthBufferTest, AWallBehindHidesNothing) {
  See(-0.1F, 0.1F, 1.1F);
  const DepthBuffer depth_buffer = Look();
  EXPECT_EQ(depth_buffer.HiddenSides(), DepthBuffer::Sides{});
  EXPECT_EQ(depth_buffer.UnseenSides(), DepthBuffer::Sides{});
}

TEST_F(DepthBufferTest, PointsInTheLensMakeNoWindow) {
  See(-0.1F, 0.1F, 1.1F);
  for (const float depth : {1e-9F, 1e-30F, 1e-4F}) {
    segment_.indices.push_back(static_cast<std::int32_t>(scan_.points.size()));
    scan_.points.emplace_back(0.02F, -0.03F, depth);
  }
  const DepthBuffer depth_buffer = Look();
  EXPECT_LT(depth_buffer.window().size[0], 200);
  EXPECT_EQ(depth_buffer.HiddenSides(), DepthBuffer::Sides{});
}

TEST_F(DepthBufferTest, APointBesideTheLensMakesNoEndlessWindow) {
  segment_.indices.push_back(static_cast<std::int32_t>(scan_.points.size()));
  scan_.points.emplace_back(90.0F, -90.0F, 0.02F);
  const simd::DepthWindow window = Look().window();
  EXPECT_LE(window.size[0], 2001);
  EXPECT_LE(window.size[1], 2001);
}

TEST_F(DepthBufferTest, ANearerObjectHidesASide) {
  See(-0.1F, -0.05F, 0.8F);
  See(-0.05F, 0.1F, 1.1F);
  const DepthBuffer depth_buffer = Look();
  EXPECT_EQ(depth_buffer.HiddenSides(), DepthBuffer::Sides{.left = true});
  EXPECT_EQ(depth_buffer.UnseenSides(), DepthBuffer::Sides{.left = true});
}

TEST_F(DepthBufferTest, UnmeasuredPixelsMayHideASide) {
  See(-0.05F, 0.1F, 1.1F);
  const DepthBuffer depth_buffer = Look();
  EXPECT_EQ(depth_buffer.HiddenSides(), DepthBuffer::Sides{});
  EXPECT_EQ(depth_buffer.UnseenSides(), DepthBuffer::Sides{.left = true});
}

// A quarter of the right edge is lost, and all of the left one.
TEST_F(DepthBufferTest, ASideThatIsLessCutThanTheOneAcrossIsFrayed) {
  for (float y = -0.1F; y < 0.1F; y += kPitchM) {
    for (float x = -0.05F; x < 0.1F; x += kPitchM) {
      const bool on_plate = std::abs(x) < 0.05F && std::abs(y) < 0.05F;
      const bool lost = x >= 0.05F && y > -0.01F && y < 0.015F;
      if (!on_plate && !lost) scan_.points.emplace_back(1.1F * x, 1.1F * y, 1.1F);
    }
  }
  EXPECT_EQ(Look().UnseenSides(), DepthBuffer::Sides{.left = true});
}

}  // namespace
}  // namespace graspdb::recognition
