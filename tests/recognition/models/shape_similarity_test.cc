#include "recognition/models/shape_similarity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace graspdb::recognition {
namespace {

// The walls and the top of a prism of `corners` at radius `radius_m`, 6 cm high, with its first
// corner at `turn_rad`; with a nose on one side where `nose_m` is not 0.
SurfaceModel Prism(int corners, double radius_m, double nose_m = 0, double turn_rad = 0) {
  const double step = radius_m < 0.2 ? 0.0025 : 0.01;
  constexpr double kHeight = 0.06;
  OrientedCloud out;
  const auto add = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    const Eigen::AngleAxisd turn(turn_rad, Eigen::Vector3d::UnitZ());
    out.points.push_back((turn * p).cast<float>());
    out.normals.push_back((turn * n).cast<float>());
  };
  const double half = std::numbers::pi / corners;
  const double inner = radius_m * std::cos(half);
  const double side = 2 * radius_m * std::sin(half);
  for (int k = 0; k < corners; ++k) {
    const Eigen::AngleAxisd to_side(2 * half * k, Eigen::Vector3d::UnitZ());
    for (double along = -side / 2; along < side / 2; along += step) {
      for (double z = 0; z < kHeight; z += step) {
        add(to_side * Eigen::Vector3d(inner, along, z), to_side * Eigen::Vector3d::UnitX());
      }
    }
  }
  for (double along = 0; nose_m > 0 && along < nose_m; along += step) {
    for (double z = 0; z < kHeight; z += step) {
      add({inner + along, 0.004, z}, Eigen::Vector3d::UnitY());
      add({inner + along, -0.004, z}, -Eigen::Vector3d::UnitY());
    }
  }
  return SurfaceModel(std::move(out), 12);
}

TEST(FindSymmetry, OfPrismsIsTheNumberOfCorners) {
  for (const int corners : {3, 4, 6}) {
    const FoundSymmetry found = FindSymmetry(Prism(corners, 0.05));
    EXPECT_EQ(found.order, corners);
    EXPECT_FALSE(found.nearly);
    EXPECT_LT(found.gap.largest_m, 0.002);
  }
}

TEST(FindSymmetry, OfARoundObjectIsAnyTurn) { EXPECT_EQ(FindSymmetry(Prism(72, 0.04)).order, 0); }

TEST(FindSymmetry, ANoseBreaksIt) { EXPECT_EQ(FindSymmetry(Prism(4, 0.04, 0.04)).order, 1); }

// Their size allows larger gaps than can be measured.
TEST(FindSymmetry, OfLargePrismsIsTheNumberOfCorners) {
  EXPECT_EQ(FindSymmetry(Prism(4, 0.35)).order, 4);
  EXPECT_EQ(FindSymmetry(Prism(4, 0.35, 0.3)).order, 1);
}

TEST(FindShapeSimilarity, LargeObjectsOfOtherShapesAreNotAlike) {
  EXPECT_FALSE(FindShapeSimilarity(Prism(4, 0.35), Prism(6, 0.35)));
  EXPECT_TRUE(FindShapeSimilarity(Prism(4, 0.35), Prism(4, 0.35, 0, 0.5)));
}

TEST(FindShapeSimilarity, TheSameObjectTaughtTwiceIsFoundInItsTurn) {
  const SurfaceModel a = Prism(4, 0.04, 0.04);
  const SurfaceModel b = Prism(4, 0.04, 0.04, 1.2);
  const auto similarity = FindShapeSimilarity(a, b);
  ASSERT_TRUE(similarity);
  EXPECT_LT(similarity->gap.largest_m, 0.002);
  const Eigen::Vector3d x = similarity->b_a.linear().col(0);
  EXPECT_NEAR(std::atan2(x.y(), x.x()), 1.2, 0.02);
}

TEST(FindShapeSimilarity, OtherShapesAndSizesAreNotAlike) {
  EXPECT_FALSE(FindShapeSimilarity(Prism(4, 0.04), Prism(4, 0.048)));
  EXPECT_FALSE(FindShapeSimilarity(Prism(3, 0.04), Prism(6, 0.04)));
  EXPECT_FALSE(FindShapeSimilarity(Prism(4, 0.04, 0.03), Prism(4, 0.065)));
}

}  // namespace
}  // namespace graspdb::recognition
