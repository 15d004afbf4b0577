#include "recognition/points/nearest_grid.h"

#include <gtest/gtest.h>

#include "recognition/points/point_search.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPoints;
using ::graspdb::testing::WavySurface;

constexpr float kCell = 0.003F;
constexpr float kReach = 0.02F;

TEST(NearestGrid, FindsNearlyTheNearestPoint) {
  Random random(5);
  const Points points = WavySurface(random, 3000).points;
  const NearestGrid grid(points, kCell, kReach);
  const PointSearch exact(points);
  const float diagonal = kCell * std::sqrt(3.0F);
  int queries = 0;
  for (const Eigen::Vector3f& query : RandomPoints(random, 4000, 0.15)) {
    const float nearest = std::sqrt(exact.Nearest(query).squared_distance);
    const int found = grid.Nearest(query);
    if (nearest > kReach) continue;
    ASSERT_GE(found, 0);
    ++queries;
    EXPECT_LE((points[static_cast<std::size_t>(found)] - query).norm(), nearest + diagonal);
  }
  EXPECT_GT(queries, 500);
}

TEST(NearestGrid, ReachesTheGivenDistanceInEveryDirection) {
  const Points point = {{0.0004F, -0.0011F, 0.0007F}};
  const NearestGrid grid(point, kCell, kReach);
  Random random(6);
  for (const Eigen::Vector3f& query : RandomPoints(random, 3000, 0.08)) {
    const float distance = (query - point.front()).norm();
    if (distance < kReach) {
      EXPECT_EQ(grid.Nearest(query), 0);
    }
    // A cell stores a point near enough to its centre, and is twice as large that far away.
    if (distance > kReach + 4 * kCell) {
      EXPECT_EQ(grid.Nearest(query), -1);
    }
  }
}

TEST(NearestGrid, FindsNoneFarFromThePoints) {
  const NearestGrid grid({{0, 0, 0}, {0.05F, 0, 0}}, kCell, kReach);
  EXPECT_EQ(grid.Nearest({0, 0, 0.06F}), -1);
  EXPECT_EQ(grid.Nearest({1, 1, 1}), -1);
  EXPECT_EQ(grid.Nearest({-1e9F, 0, 0}), -1);
  EXPECT_EQ(grid.Nearest({std::nanf(""), 0, 0}), -1);
}

// A grid over the box around them would have 10^10 cells.
TEST(NearestGrid, MemoryGrowsWithThePointsAndNotWithTheVolume) {
  Random random(7);
  Points points = WavySurface(random, 3000).points;
  const std::size_t compact = NearestGrid(points, kCell, kReach).bytes();
  points.emplace_back(0, 0, 0.6F);
  const NearestGrid grid(points, kCell, kReach);
  EXPECT_LT(grid.bytes(), compact + (1U << 20U));
  EXPECT_EQ(grid.Nearest({0, 0, 0.61F}), 3000);
  EXPECT_EQ(grid.Nearest(points.front()),
            NearestGrid(points, kCell, kReach).Nearest(points.front()));
}

TEST(NearestGrid, FarPointsDoNotFillTheMemory) {
  Random random(8);
  Points points = WavySurface(random, 3000).points;
  points.emplace_back(80, -80, 80);
  const NearestGrid grid(points, kCell, kReach);
  EXPECT_LT(grid.bytes(), std::size_t{80} << 20U);
  EXPECT_EQ(grid.Nearest({80, -80, 80}), 3000);
}

TEST(NearestGrid, ScatteredPointsDoNotFillTheMemory) {
  Random random(9);
  const Points points = RandomPoints(random, 100'000, 1);
  const NearestGrid grid(points, kCell, kReach);
  EXPECT_LT(grid.bytes(), std::size_t{80} << 20U);
  EXPECT_GE(grid.Nearest(points[7]), 0);
}

TEST(NearestGrid, FindsNoneWithoutPoints) {
  EXPECT_EQ(NearestGrid({}, kCell, kReach).Nearest({0, 0, 0}), -1);
}

}  // namespace
}  // namespace graspdb::recognition
