#include "recognition/points/depth_image.h"

#include <gtest/gtest.h>

#include <cmath>

namespace graspdb::recognition {
namespace {

// 3 x 2 pixels with different focal lengths, so that a swap of u and v shows.
constexpr CameraIntrinsics kCamera{3, 2, 100, 50, 1, 0.5};

TEST(DepthImageTest, PixelsBecomePointsRowByRow) {
  const Points points = PointsOf({{1000, 1000, 1000, 2000, 2000, 500}, kCamera, 0.001});
  ASSERT_EQ(points.size(), 6U);
  EXPECT_TRUE(points[0].isApprox(Eigen::Vector3f(-0.01F, -0.01F, 1)));
  EXPECT_TRUE(points[1].isApprox(Eigen::Vector3f(0, -0.01F, 1)));
  EXPECT_TRUE(points[3].isApprox(Eigen::Vector3f(-0.02F, 0.02F, 2)));
  EXPECT_TRUE(points[5].isApprox(Eigen::Vector3f(0.005F, 0.005F, 0.5F)));
}

TEST(DepthImageTest, PixelWithoutDepthBecomesNan) {
  const Points points = PointsOf({{1000, 0, 1000, 1000, 1000, 1000}, kCamera, 0.001});
  for (const float x : points[1]) EXPECT_TRUE(std::isnan(x));
  EXPECT_TRUE(points[2].allFinite());
}

TEST(DepthImageTest, LargestCountAndOtherUnitsAreTakenWhole) {
  const DepthImage image{{65535, 65535, 65535, 65535, 65535, 65535}, kCamera, 0.0001};
  EXPECT_FLOAT_EQ(PointsOf(image)[4].z(), 6.5535F);
}

}  // namespace
}  // namespace graspdb::recognition
