// Thinning to one point a cell and side.
#include "recognition/points/thinned.h"

#include <gtest/gtest.h>

namespace graspdb::recognition {
namespace {

TEST(ThinnedToCells, PointsOfACellBecomeTheirMean) {
  const Eigen::Vector3f up(0, 0, 1);
  const OrientedCloud thinned =
      ThinnedToCells({{{0.001F, 0, 0}, {0.003F, 0, 0}, {0.013F, 0, 0}}, {up, up, up}}, 0.01F);
  ASSERT_EQ(thinned.points.size(), 2U);
  EXPECT_TRUE(thinned.points[0].isApprox(Eigen::Vector3f(0.002F, 0, 0)));
  EXPECT_TRUE(thinned.points[1].isApprox(Eigen::Vector3f(0.013F, 0, 0)));
}

TEST(ThinnedToCells, TheTwoSidesOfASheetStayApart) {
  const Eigen::Vector3f up(0, 0, 1);
  const OrientedCloud thinned =
      ThinnedToCells({{{0, 0, 0}, {0.001F, 0, 0}, {0.002F, 0, 0}}, {up, -up, up}}, 0.01F);
  ASSERT_EQ(thinned.points.size(), 2U);
  EXPECT_TRUE(thinned.normals[0].isApprox(up));
  EXPECT_TRUE(thinned.normals[1].isApprox(-up));
}

TEST(ThinnedToCells, NoPointsGiveNone) { EXPECT_TRUE(ThinnedToCells({}, 0.01F).points.empty()); }

}  // namespace
}  // namespace graspdb::recognition
