#include "recognition/points/plane.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPoints;
using ::graspdb::testing::Uniform;

Vector3d Above() { return {0, 0, 1}; }

// `count` points of a square of 1 m on the plane, off by at most `noise_m`.
Points OnPlane(Random& random, const Plane& plane, int count, double noise_m) {
  const Eigen::Quaterniond tilt =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), plane.normal);
  Points out;
  for (int i = 0; i < count; ++i) {
    const Vector3d flat(Uniform(random, -0.5, 0.5), Uniform(random, -0.5, 0.5),
                        plane.offset + Uniform(random, -noise_m, noise_m));
    out.emplace_back((tilt * flat).cast<float>());
  }
  return out;
}

void Append(const Points& more, Points* points) {
  points->insert(points->end(), more.begin(), more.end());
}

double AngleBetween(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(FindPlaneTest, PlaneIsRecoveredFromNoiseAndOutliers) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    const Plane truth{Vector3d(0.1, -0.15, 1).normalized(), 0.02};
    Points points = OnPlane(random, truth, 3000, 0.002);
    Append(RandomPoints(random, 4000, 1), &points);
    std::shuffle(points.begin(), points.end(), random);
    const auto found = FindPlane(points, Above(), {});
    ASSERT_TRUE(found) << seed;
    EXPECT_LT(AngleBetween(found->normal, truth.normal), 0.003) << seed;
    EXPECT_NEAR(found->offset, truth.offset, 0.0007) << seed;
  }
}

TEST(FindPlaneTest, ExactPlaneIsFoundExactly) {
  Random random(6);
  const Plane truth{Vector3d(-0.3, 0.2, 1).normalized(), -0.1};
  const auto found = FindPlane(OnPlane(random, truth, 500, 0), Above(), {});
  ASSERT_TRUE(found);
  EXPECT_LT(AngleBetween(found->normal, truth.normal), 1e-6);
  EXPECT_NEAR(found->offset, truth.offset, 1e-6);
}

TEST(FindPlaneTest, NormalPointsToTheSideOfTheViewpoint) {
  Random random(7);
  const Points points = OnPlane(random, {}, 500, 0.001);
  EXPECT_GT(FindPlane(points, {0, 0, 1}, {})->normal.z(), 0.99);
  EXPECT_LT(FindPlane(points, {0, 0, -1}, {})->normal.z(), -0.99);
}

TEST(FindPlaneTest, LargerOfTwoPlanesIsTaken) {
  Random random(8);
  Points points = OnPlane(random, {Vector3d::UnitZ(), 0.3}, 400, 0.001);
  Append(OnPlane(random, {Vector3d::UnitZ(), 0}, 900, 0.001), &points);
  EXPECT_NEAR(FindPlane(points, Above(), {})->offset, 0, 0.001);
}

// The larger plane is a wall; only the table stands upright.
TEST(FindPlaneTest, PlaneTiltedTooFarIsSkipped) {
  Random random(9);
  Points points = OnPlane(random, {Vector3d::UnitX(), 0.5}, 2000, 0.001);
  Append(OnPlane(random, {Vector3d(0, 0.1, 1).normalized(), 0}, 800, 0.001), &points);
  PlaneConstraint constraint;
  constraint.max_tilt_rad = 0.17;
  const auto found = FindPlane(points, Above(), constraint);
  ASSERT_TRUE(found);
  EXPECT_LT(AngleBetween(found->normal, Vector3d(0, 0.1, 1)), 0.003);
  constraint.max_tilt_rad = 0.05;
  const auto narrow = FindPlane(points, Above(), constraint);
  if (narrow) {
    EXPECT_LE(AngleBetween(narrow->normal, Vector3d::UnitZ()), 0.05 + 1e-6);
  }
}

TEST(FindPlaneTest, PlaneFarFromTheOriginIsSkipped) {
  Random random(10);
  Points points = OnPlane(random, {Vector3d::UnitZ(), 0.2}, 2000, 0.001);
  Append(OnPlane(random, {Vector3d::UnitZ(), 0.01}, 800, 0.001), &points);
  PlaneConstraint constraint;
  constraint.max_tilt_rad = 0.1;
  constraint.max_offset_m = 0.03;
  const auto found = FindPlane(points, Above(), constraint);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->offset, 0.01, 0.001);
}

TEST(FindPlaneTest, PlaneWithTooSmallAShareIsRejected) {
  Random random(11);
  Points points = OnPlane(random, {}, 300, 0.001);
  Append(RandomPoints(random, 2700, 1), &points);
  PlaneConstraint constraint;
  constraint.min_share = 0.3;
  EXPECT_FALSE(FindPlane(points, Above(), constraint));
}

// A plane that has just the share it needs must not be missed by bad luck in the draws.
TEST(FindPlaneTest, PlaneWithJustTheMinimumShareIsFound) {
  PlaneConstraint constraint;
  constraint.min_share = 0.10;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    Points points = OnPlane(random, {}, 360, 0.001);
    Append(RandomPoints(random, 2640, 1), &points);
    const auto plane = FindPlane(points, Above(), constraint);
    found += plane && AngleBetween(plane->normal, Vector3d::UnitZ()) < 0.02 ? 1 : 0;
  }
  EXPECT_EQ(found, 20);
}

TEST(FindPlaneTest, FewerThanThreePointsHaveNoPlane) {
  EXPECT_FALSE(FindPlane({}, Above(), {}));
  EXPECT_FALSE(FindPlane({{0, 0, 0}}, Above(), {}));
  EXPECT_FALSE(FindPlane({{0, 0, 0}, {1, 0, 0}}, Above(), {}));
  EXPECT_TRUE(FindPlane({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Above(), {}));
}

TEST(FindPlaneTest, CoincidentPointsHaveNoPlane) {
  EXPECT_FALSE(FindPlane(Points(100, {0.1F, 0.2F, 0.3F}), Above(), {}));
}

TEST(FindPlaneTest, CollinearPointsHaveNoPlane) {
  for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(0.3, 0.1, -0.7)}) {
    Points points;
    for (int i = 0; i < 200; ++i) {
      points.emplace_back((Vector3d(0.1, 0.2, 0.3) + 0.005 * i * direction).cast<float>());
    }
    EXPECT_FALSE(FindPlane(points, Above(), {})) << direction.transpose();
  }
}

TEST(FindPlaneTest, SameInputGivesTheSameBits) {
  Random random(12);
  Points points = OnPlane(random, {}, 2000, 0.003);
  Append(RandomPoints(random, 9000, 1), &points);
  const auto first = FindPlane(points, Above(), {});
  ASSERT_TRUE(first);
  for (int i = 0; i < 3; ++i) {
    const auto again = FindPlane(points, Above(), {});
    EXPECT_EQ(again->normal, first->normal);
    EXPECT_EQ(again->offset, first->offset);
  }
}

TEST(PlaneTest, HeightIsPositiveOnTheSideOfTheNormal) {
  const Plane plane{Vector3d::UnitY(), 0.5};
  EXPECT_DOUBLE_EQ(plane.Height({7, 0.75, -7}), 0.25);
  EXPECT_DOUBLE_EQ(plane.Height({0, 0, 0}), -0.5);
}

}  // namespace
}  // namespace graspdb::recognition
