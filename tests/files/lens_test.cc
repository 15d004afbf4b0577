#include "files/depth/lens.h"

#include <gtest/gtest.h>

#include <cmath>

namespace graspdb::files {
namespace {

using Eigen::Vector2d;

TEST(Lens, OpenCvsCoefficientsAreUndone) {
  // A point at (0.3, -0.2) and where OpenCV's projectPoints shows it, by hand from its formula.
  const Lens lens = {.coefficients = {0.1, -0.05, 0.001, -0.002, 0.01, 0.02, 0.003, -0.001}};
  const double x = 0.3;
  const double y = -0.2;
  const double r2 = x * x + y * y;
  const double radial = (1 + 0.1 * r2 - 0.05 * r2 * r2 + 0.01 * std::pow(r2, 3)) /
                        (1 + 0.02 * r2 + 0.003 * r2 * r2 - 0.001 * std::pow(r2, 3));
  const Vector2d shown(x * radial + 2 * 0.001 * x * y - 0.002 * (r2 + 2 * x * x),
                       y * radial + 0.001 * (r2 + 2 * y * y) - 2 * 0.002 * x * y);
  const auto found = Undistorted(lens, shown);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - Vector2d(x, y)).norm(), 1e-6);
  EXPECT_GT((shown - Vector2d(x, y)).norm(), 1e-3);
}

TEST(Lens, AStrongKinectsDistortionIsUndoneInTheCorners) {
  const Lens lens = {.coefficients = {0.09, -0.27, 0, 0, 0.09}};
  for (const double x : {0.0, 0.3, 0.6, 0.7}) {
    const auto found = Undistorted(lens, {x, 0.5});
    ASSERT_TRUE(found) << x;
    EXPECT_LT((*found - Vector2d(x, 0.5)).norm(), 0.2);
  }
}

TEST(Lens, APlaceThatNoRayReachesHasNone) {
  const Lens lens = {.coefficients = {-1}};  // its image ends at 0.385
  EXPECT_TRUE(Undistorted(lens, {0.3, 0}));
  EXPECT_FALSE(Undistorted(lens, {0.6, 0}));
}

}  // namespace
}  // namespace graspdb::files
