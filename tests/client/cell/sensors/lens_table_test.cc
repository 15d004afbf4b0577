// Undistortion tables.
#include "client/cell/sensors/lens_table.h"

#include <gmock/gmock.h>

#include <Eigen/Core>

namespace graspdb::client {
namespace {

const recognition::CameraIntrinsics pinhole = {
    .width = 512, .height = 424, .fx = 365, .fy = 366, .cx = 255.2, .cy = 208.4};
// Of a Kinect v2.
const std::array<double, 5> kinect_distortion = {0.097, -0.274, 0.001, -0.0007, 0.098};

TEST(LensTable, IsTheIdentityWithoutDistortion) {
  const auto table = LensTable(pinhole, {});
  ASSERT_EQ(table.size(), 512U * 424);
  for (std::size_t i = 0; i < table.size(); ++i) ASSERT_EQ(table[i], i);
}

// Direction of a lens pixel, x / z and y / z: the distortion has no inverse in closed form and is
// removed by fixed-point iteration.
Eigen::Vector2d DirectionOf(const Eigen::Vector2d& pixel) {
  const auto& [k1, k2, p1, p2, k3] = kinect_distortion;
  const Eigen::Vector2d seen((pixel.x() - pinhole.cx) / pinhole.fx,
                             (pixel.y() - pinhole.cy) / pinhole.fy);
  Eigen::Vector2d p = seen;
  for (int i = 0; i < 10; ++i) {
    const double r2 = p.squaredNorm();
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    p = (seen - Eigen::Vector2d(2 * p1 * p.x() * p.y() + p2 * (r2 + 2 * p.x() * p.x()),
                                p1 * (r2 + 2 * p.y() * p.y()) + 2 * p2 * p.x() * p.y())) /
        radial;
  }
  return p;
}

// Checked with an independent inverse: the ray of a lens pixel.
TEST(LensTable, InvertsTheDistortion) {
  const auto table = LensTable(pinhole, kinect_distortion);
  int moved = 0;
  for (int v = 10; v < 420; v += 37) {
    for (int u = 10; u < 510; u += 41) {
      const std::int32_t pixel =
          table[std::size_t{512} * static_cast<std::size_t>(v) + static_cast<std::size_t>(u)];
      if (pixel < 0) continue;
      moved += pixel != v * 512 + u ? 1 : 0;
      const Eigen::Vector2d looks = DirectionOf({pixel % 512, pixel / 512});
      // Half a pixel of rounding, stretched by the lens.
      EXPECT_NEAR(looks.x(), (u - pinhole.cx) / pinhole.fx, 0.7 / pinhole.fx) << u << " " << v;
      EXPECT_NEAR(looks.y(), (v - pinhole.cy) / pinhole.fy, 0.7 / pinhole.fy) << u << " " << v;
    }
  }
  EXPECT_GT(moved, 50);
}

TEST(LensTable, PixelsOutsideTheLensImageAreMinusOne) {
  // The pinhole's corners are outside this lens's image.
  const auto table = LensTable(pinhole, {0.5, 0, 0, 0, 0});
  EXPECT_EQ(table.front(), -1);
  EXPECT_EQ(table.back(), -1);
  EXPECT_NE(table[std::size_t{208} * 512 + 255], -1);
}

}  // namespace
}  // namespace graspdb::client
