// Images of a lens as images of a pinhole.
#include "client/cell/sensors/lens_table.h"

#include <gmock/gmock.h>

#include <cmath>

#include "lab/datasets/depth_map.h"

namespace graspdb::client {
namespace {

const recognition::CameraIntrinsics pinhole = {
    .width = 512, .height = 424, .fx = 365, .fy = 366, .cx = 255.2, .cy = 208.4};
// As a Kinect v2 says it.
const std::array<double, 5> kinect_distortion = {0.097, -0.274, 0.001, -0.0007, 0.098};

TEST(LensTable, WithoutDistortionNothingMoves) {
  const auto table = LensTable(pinhole, {});
  ASSERT_EQ(table.size(), 512U * 424);
  for (std::size_t i = 0; i < table.size(); ++i) ASSERT_EQ(table[i], i);
}

// The inverse is known from elsewhere: where a pixel of the lens looks.
TEST(LensTable, ThePixelLooksWhereThePinholeDoes) {
  const auto table = LensTable(pinhole, kinect_distortion);
  DepthLens lens;
  lens.fx = pinhole.fx;
  lens.fy = pinhole.fy;
  lens.cx = pinhole.cx;
  lens.cy = pinhole.cy;
  lens.distortion = kinect_distortion;
  int moved = 0;
  for (int v = 10; v < 420; v += 37) {
    for (int u = 10; u < 510; u += 41) {
      const std::int32_t pixel =
          table[std::size_t{512} * static_cast<std::size_t>(v) + static_cast<std::size_t>(u)];
      if (pixel < 0) continue;
      moved += pixel != v * 512 + u ? 1 : 0;
      const Eigen::Vector2d looks = DirectionOf(lens, {pixel % 512, pixel / 512});
      // Half a pixel of rounding, and what the lens stretches it.
      EXPECT_NEAR(looks.x(), (u - pinhole.cx) / pinhole.fx, 0.7 / pinhole.fx) << u << " " << v;
      EXPECT_NEAR(looks.y(), (v - pinhole.cy) / pinhole.fy, 0.7 / pinhole.fy) << u << " " << v;
    }
  }
  EXPECT_GT(moved, 50);
}

TEST(LensTable, WhatTheLensDoesNotSeeIsNone) {
  // The pinhole's corners look where this lens's image has no more pixels.
  const auto table = LensTable(pinhole, {0.5, 0, 0, 0, 0});
  EXPECT_EQ(table.front(), -1);
  EXPECT_EQ(table.back(), -1);
  EXPECT_NE(table[std::size_t{208} * 512 + 255], -1);
}

}  // namespace
}  // namespace graspdb::client
