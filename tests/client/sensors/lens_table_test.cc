// Images of a lens as images of a pinhole.
#include "client/sensors/lens_table.h"

#include <gmock/gmock.h>

#include <cmath>

#include "client/files/depth_map.h"

namespace graspdb::client {
namespace {

const recognition::CameraIntrinsics kCamera = {
    .width = 512, .height = 424, .fx = 365, .fy = 366, .cx = 255.2, .cy = 208.4};
// As a Kinect v2 says it.
const std::array<double, 5> kDistortion = {0.097, -0.274, 0.001, -0.0007, 0.098};

TEST(LensTable, WithoutDistortionNothingMoves) {
  const auto table = LensTable(kCamera, {});
  ASSERT_EQ(table.size(), 512U * 424);
  for (std::size_t i = 0; i < table.size(); ++i) ASSERT_EQ(table[i], i);
}

// The inverse is known from elsewhere: where a pixel of the lens looks.
TEST(LensTable, ThePixelLooksWhereThePinholeDoes) {
  const auto table = LensTable(kCamera, kDistortion);
  DepthLens lens;
  lens.fx = kCamera.fx;
  lens.fy = kCamera.fy;
  lens.cx = kCamera.cx;
  lens.cy = kCamera.cy;
  lens.distortion = kDistortion;
  int moved = 0;
  for (int v = 10; v < 420; v += 37) {
    for (int u = 10; u < 510; u += 41) {
      const std::int32_t pixel = table[static_cast<std::size_t>(v * 512 + u)];
      if (pixel < 0) continue;
      moved += pixel != v * 512 + u ? 1 : 0;
      const Eigen::Vector2d looks = DirectionOf(lens, {pixel % 512, pixel / 512});
      // Half a pixel of rounding, and what the lens stretches it.
      EXPECT_NEAR(looks.x(), (u - kCamera.cx) / kCamera.fx, 0.7 / kCamera.fx) << u << " " << v;
      EXPECT_NEAR(looks.y(), (v - kCamera.cy) / kCamera.fy, 0.7 / kCamera.fy) << u << " " << v;
    }
  }
  EXPECT_GT(moved, 50);
}

TEST(LensTable, WhatTheLensDoesNotSeeIsNone) {
  // The pinhole's corners look where this lens's image has no more pixels.
  const auto table = LensTable(kCamera, {0.5, 0, 0, 0, 0});
  EXPECT_EQ(table.front(), -1);
  EXPECT_EQ(table.back(), -1);
  EXPECT_NE(table[std::size_t{208} * 512 + 255], -1);
}

}  // namespace
}  // namespace graspdb::client
