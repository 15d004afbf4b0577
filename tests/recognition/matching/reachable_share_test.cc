#include "recognition/matching/reachable_share.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace graspdb::recognition {
namespace {

// Evenly spread over a box.
Points PointsIn(const Eigen::Vector3f& size, int count) {
  std::mt19937 random_numbers(1);
  std::uniform_real_distribution<float> share(0, 1);
  Points out;
  for (int i = 0; i < count; ++i) {
    const float x = share(random_numbers);
    const float y = share(random_numbers);
    out.emplace_back(x * size.x(), y * size.y(), share(random_numbers) * size.z());
  }
  return out;
}

double ShareIn(const Points& points, const Eigen::Vector3f& center, float radius_m) {
  const auto inside = std::ranges::count_if(
      points, [&](const Eigen::Vector3f& p) { return (p - center).norm() <= radius_m; });
  return static_cast<double>(inside) / static_cast<double>(points.size());
}

TEST(ReachableShare, NoSphereContainsMore) {
  const Points points = PointsIn({0.4F, 0.1F, 0.05F}, 500);
  const ReachableShare reachable(points, 1);
  for (const float radius_m : {0.0F, 0.001F, 0.02F, 0.05F, 0.1F, 0.3F}) {
    for (const Eigen::Vector3f& center : points) {
      EXPECT_GE(reachable.Within(radius_m), ShareIn(points, center, radius_m));
    }
  }
}

TEST(ReachableShare, ASphereContainsLittleMoreThanItsWidth) {
  const ReachableShare reachable(PointsIn({0.4F, 0.1F, 0.05F}, 20'000), 1);
  EXPECT_NEAR(reachable.Within(0.05F), 0.25, 0.08);
  EXPECT_EQ(reachable.Within(0.21F), 1);
}

TEST(ReachableShare, HeightsAreThoseOfThePoints) {
  const ReachableShare reachable(PointsIn({0.4F, 0.1F, 0.05F}, 20'000), 1);
  EXPECT_EQ(reachable.NotHigher(-0.001F), 0);
  EXPECT_NEAR(reachable.NotHigher(0.02F), 0.4, 0.02);
  EXPECT_EQ(reachable.NotHigher(0.05F), 1);
}

TEST(ReachableShare, CoincidentPointsAreAllReached) {
  const ReachableShare reachable(Points(100, Eigen::Vector3f(1, 2, 3)), 7);
  EXPECT_EQ(reachable.Within(0), 1);
  EXPECT_EQ(reachable.NotHigher(3), 1);
}

TEST(ReachableShare, IsOneWithoutPoints) {
  const ReachableShare reachable({}, 1);
  EXPECT_EQ(reachable.Within(0), 1);
  EXPECT_EQ(reachable.NotHigher(0), 1);
}

}  // namespace
}  // namespace graspdb::recognition
