#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "recognition/points/normals.h"
#include "recognition/points/voxels.h"
#include "recognition/segmentation/outliers.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPoints;
using ::graspdb::testing::Uniform;
using ::graspdb::testing::WavySurface;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(VoxelsTest, PointsOfAVoxelBecomeTheirCentroid) {
  const VoxelCloud voxels =
      DownsampleToVoxels({{0.1F, 0.1F, 0.1F}, {1.5F, 0.1F, 0.1F}, {0.3F, 0.5F, 0.9F}}, 1);
  ASSERT_THAT(voxels.points, SizeIs(2));
  EXPECT_TRUE(voxels.points[0].isApprox(Vector3f(0.2F, 0.3F, 0.5F)));
  EXPECT_EQ(voxels.points[1], Vector3f(1.5F, 0.1F, 0.1F));
  EXPECT_THAT(voxels.voxel_of, ElementsAre(0, 1, 0));
}

TEST(VoxelsTest, VoxelsMeetAtTheOriginAndDoNotStraddleIt) {
  const VoxelCloud voxels = DownsampleToVoxels({{0.4F, 0, 0}, {-0.4F, 0, 0}, {-0.6F, 0, 0}}, 1);
  ASSERT_THAT(voxels.points, SizeIs(2));
  EXPECT_TRUE(voxels.points[0].isApprox(Vector3f(-0.5F, 0, 0)));
  EXPECT_EQ(voxels.points[1], Vector3f(0.4F, 0, 0));
}

TEST(VoxelsTest, VoxelsAreSortedByZThenYThenX) {
  const VoxelCloud voxels = DownsampleToVoxels(
      {{0.5F, 0.5F, 1.5F}, {0.5F, 1.5F, 0.5F}, {1.5F, 0.5F, 0.5F}, {0.5F, 0.5F, 0.5F}}, 1);
  EXPECT_THAT(voxels.voxel_of, ElementsAre(3, 2, 1, 0));
}

TEST(VoxelsTest, OrderOfTheInputDoesNotMatter) {
  Random random(8);
  Points points = RandomPoints(random, 5000, 0.05);
  const Points before = DownsampleToVoxels(points, 0.003).points;
  std::shuffle(points.begin(), points.end(), random);
  const VoxelCloud after = DownsampleToVoxels(points, 0.003);
  ASSERT_THAT(after.points, SizeIs(before.size()));
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT((before[i] - after.points[i]).norm(), 1e-7F);
  }
}

TEST(VoxelsTest, EveryPointLiesInItsReportedVoxel) {
  Random random(9);
  const Points points = RandomPoints(random, 2000, 0.05);
  const VoxelCloud voxels = DownsampleToVoxels(points, 0.003);
  ASSERT_THAT(voxels.voxel_of, SizeIs(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3f& centroid = voxels.points[static_cast<std::size_t>(voxels.voxel_of[i])];
    EXPECT_LE((points[i] - centroid).cwiseAbs().maxCoeff(), 0.003F);
  }
}

TEST(VoxelsTest, NoPointsGiveNoVoxels) { EXPECT_THAT(DownsampleToVoxels({}, 1).points, IsEmpty()); }

TEST(OutliersTest, PointFarFromTheRestIsRemoved) {
  Random random(10);
  Points points = RandomPoints(random, 500, 0.1);
  points.insert(points.begin() + 123, Vector3f(1, 1, 1));
  const Indices kept = RemoveStatisticalOutliers(points, 20, 3).value();
  EXPECT_FALSE(std::ranges::binary_search(kept, 123));
  EXPECT_GE(kept.size(), 480U);
  EXPECT_TRUE(std::ranges::is_sorted(kept));
}

// Two pieces of wall, of which the nearer one has nine tenths of the points.
TEST(OutliersTest, SparsePointsFarFromTheCameraAreNoOutliers) {
  Points points;
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 60; ++column) {
      const Vector3f ray(0.002F * static_cast<float>(column), 0.002F * static_cast<float>(row), 1);
      points.push_back(0.3F * ray);
      if (row < 20 && column < 20) points.push_back(0.9F * (ray + Vector3f(0.3F, 0, 0)));
    }
  }
  const Vector3f lens = Vector3f::Zero();
  const auto count_far = [&](const Indices& kept) {
    return std::ranges::count_if(
        kept, [&](std::int32_t i) { return points[static_cast<std::size_t>(i)].z() > 0.5F; });
  };
  EXPECT_LT(count_far(*RemoveStatisticalOutliers(points, 20, 2)), 100);
  EXPECT_GT(count_far(*RemoveStatisticalOutliers(points, 20, 2, {}, &lens)), 300);
}

TEST(OutliersTest, NoMorePointsThanNeighborsAreAllKept) {
  Random random(11);
  Points points = RandomPoints(random, 19, 0.1);
  points.emplace_back(9.0F, 9.0F, 9.0F);
  EXPECT_THAT(*RemoveStatisticalOutliers(points, 20, 1), SizeIs(20));
  EXPECT_THAT(*RemoveStatisticalOutliers(points, 19, 1), SizeIs(19));
  EXPECT_THAT(*RemoveStatisticalOutliers({}, 20, 1), IsEmpty());
}

TEST(OutliersTest, NoNeighborsTurnTheFilterOff) {
  EXPECT_THAT(*RemoveStatisticalOutliers({{0, 0, 0}, {0, 0, 1}, {9, 9, 9}}, 0, 0.1), SizeIs(3));
}

TEST(OutliersTest, PointsInOnePlaceAreAllKept) {
  EXPECT_THAT(*RemoveStatisticalOutliers(Points(100, {1, 2, 3}), 10, 0), SizeIs(100));
}

TEST(OutliersTest, FailsWhereItWouldTakeTooLong) {
  // Half of them in one place: each has all of these as its nearest.
  Random random(14);
  Points points = RandomPoints(random, 100'000, 0.5);
  points.insert(points.end(), 100'000, Vector3f(0.1F, 0.1F, 0.1F));
  EXPECT_FALSE(RemoveStatisticalOutliers(points, 50, 2));
}

TEST(OutliersTest, FarStraysChangeNothingElse) {
  Random random(15);
  const Points surface = testing::WavySurface(random, 20'000).points;
  Points points = surface;
  for (const Vector3f& stray : RandomPoints(random, 50, 160)) points.push_back(stray);
  const auto kept = RemoveStatisticalOutliers(points, 50, 2);
  ASSERT_TRUE(kept);
  EXPECT_GE(kept->size(), surface.size());
  EXPECT_LT(static_cast<std::size_t>(kept->back()), surface.size() + 50);
  EXPECT_EQ(kept, RemoveStatisticalOutliers(points, 50, 2));
}

TEST(OutliersTest, CancellingEndsIt) {
  Random random(16);
  int polls = 0;
  EXPECT_FALSE(RemoveStatisticalOutliers(RandomPoints(random, 200'000, 0.3), 50, 2,
                                         [&] { return ++polls == 3; }));
  EXPECT_EQ(polls, 3);
}

TEST(NormalsTest, NormalsOfAPlaneAreItsOwnAndFaceTheViewpoint) {
  Random random(12);
  const Vector3d truth = Vector3d(0.2, -0.3, 0.9).normalized();
  const Eigen::Quaterniond tilt = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), truth);
  Points points;
  for (int i = 0; i < 1500; ++i) {
    const Vector3d flat(Uniform(random, -0.05, 0.05), Uniform(random, -0.05, 0.05), 0);
    points.emplace_back((tilt * flat).cast<float>());
  }
  for (const double side : {1.0, -1.0}) {
    for (const auto& normal : EstimateNormals(points, side * truth, 0.01)) {
      EXPECT_NEAR(normal.norm(), 1, 1e-6);
      EXPECT_GT(normal.cast<double>().dot(side * truth), 1 - 1e-6);
    }
  }
}

TEST(NormalsTest, NormalsOfACurvedSurfaceAreNearTheTrueOnes) {
  Random random(13);
  const OrientedCloud cloud = WavySurface(random, 8000);
  const Normals found = EstimateNormals(cloud.points, {0, 0, 1}, 0.004);
  double worst = 1;
  double sum = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    worst = std::min<double>(worst, found[i].dot(cloud.normals[i]));
    sum += found[i].dot(cloud.normals[i]);
  }
  EXPECT_GT(sum / static_cast<double>(found.size()), std::cos(0.06));
  EXPECT_GT(worst, std::cos(0.6));
}

TEST(NormalsTest, PointWithoutNeighborsLooksAtTheViewpoint) {
  const Points points = {{0, 0, 0}, {1, 0, 0}, {1.001F, 0, 0}};
  const Normals normals = EstimateNormals(points, {0, 0, 2}, 0.01);
  EXPECT_EQ(normals[0], Vector3f(0, 0, 1));
  EXPECT_TRUE(normals[1].isApprox(Vector3d(-1, 0, 2).normalized().cast<float>()));
}

TEST(NormalsTest, NeighborsOnALineOrInOnePlaceStillGiveUnitNormals) {
  Points points(20, {0.5F, 0.5F, 0.5F});
  for (int i = 0; i < 20; ++i) points.emplace_back(0.001F * static_cast<float>(i), 0.0F, 0.0F);
  for (const auto& n : EstimateNormals(points, {0, 0, 2}, 0.01)) {
    EXPECT_NEAR(n.norm(), 1, 1e-5);
  }
}

TEST(NormalsTest, NormalAtTheViewpointItselfIsStillAUnitVector) {
  const Points points = {{0, 0, 0}, {1, 0, 0}};
  const Normals normals = EstimateNormals(points, {0, 0, 0}, 0.01);
  EXPECT_NEAR(normals[0].norm(), 1, 1e-5);
}

}  // namespace
}  // namespace graspdb::recognition
