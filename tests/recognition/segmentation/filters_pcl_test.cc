// Voxel grid and outlier removal against the Point Cloud Library's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>

#include <cmath>

#include "recognition/points/normals.h"
#include "recognition/points/point_search.h"
#include "recognition/points/voxels.h"
#include "recognition/segmentation/outliers.h"
#include "tests/recognition/scenes/pcl_clouds.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPoints;
using ::graspdb::testing::ToPcl;
using ::graspdb::testing::WavySurface;
using ::testing::ElementsAreArray;

// Without the points so near to a voxel's face that single and double precision may
// put them on different sides.
Points AwayFromFaces(Points points, double voxel_size_m) {
  std::erase_if(points, [&](const Eigen::Vector3f& p) {
    const Eigen::Array3d at = p.cast<double>().array() / voxel_size_m;
    return ((at - at.round()).abs() < 1e-3).any();
  });
  return points;
}

class VoxelGridPclTest : public ::testing::TestWithParam<double> {};

TEST_P(VoxelGridPclTest, CentroidsAreTheSameSet) {
  const double size = GetParam();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    Points points = RandomPoints(random, 10000, 0.1);
    const Points surface = WavySurface(random, 10000).points;
    points.insert(points.end(), surface.begin(), surface.end());
    points = AwayFromFaces(std::move(points), size);

    pcl::VoxelGrid<pcl::PointXYZ> grid;
    const auto leaf = static_cast<float>(size);
    grid.setLeafSize(leaf, leaf, leaf);
    grid.setInputCloud(ToPcl(points));
    pcl::PointCloud<pcl::PointXYZ> theirs;
    grid.filter(theirs);

    const Points ours = DownsampleToVoxels(points, size).points;
    ASSERT_EQ(ours.size(), theirs.size());
    const PointSearch search(ours);
    std::vector<bool> taken(ours.size(), false);
    for (const pcl::PointXYZ& p : theirs) {
      const Neighbor n = search.Nearest(p.getVector3fMap());
      EXPECT_LT(std::sqrt(n.squared_distance), 1e-6F);
      EXPECT_FALSE(taken[static_cast<std::size_t>(n.index)]);
      taken[static_cast<std::size_t>(n.index)] = true;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, VoxelGridPclTest, ::testing::Values(0.003, 0.01));

struct OutlierCase {
  int neighbor_count;
  double deviation_factor;
};

class OutliersPclTest : public ::testing::TestWithParam<OutlierCase> {};

TEST_P(OutliersPclTest, TheSamePointsAreKept) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Random random(seed);
    Points points = WavySurface(random, 4000).points;
    const Points stray = RandomPoints(random, 200, 0.3);
    points.insert(points.end(), stray.begin(), stray.end());

    pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
    filter.setMeanK(GetParam().neighbor_count);
    filter.setStddevMulThresh(GetParam().deviation_factor);
    filter.setInputCloud(ToPcl(points));
    pcl::Indices theirs;
    filter.filter(theirs);

    const Indices ours =
        *RemoveStatisticalOutliers(points, GetParam().neighbor_count, GetParam().deviation_factor);
    EXPECT_LT(ours.size(), points.size());
    EXPECT_THAT(ours, ElementsAreArray(theirs)) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Parameters, OutliersPclTest,
                         ::testing::Values(OutlierCase{50, 2.0}, OutlierCase{50, 1.0},
                                           OutlierCase{8, 0.5}, OutlierCase{1, 1.0}));

}  // namespace
}  // namespace graspdb::recognition
