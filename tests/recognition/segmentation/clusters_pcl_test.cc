// Euclidean clusters against the Point Cloud Library's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>

#include <algorithm>

#include "recognition/segmentation/clusters.h"
#include "tests/recognition/scenes/pcl_clouds.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPoints;
using ::graspdb::testing::ToPcl;
using ::testing::ElementsAreArray;

std::vector<Indices> PclClusters(const Points& points, double tolerance_m, int min_count) {
  const auto cloud = ToPcl(points);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(cloud);
  extraction.setSearchMethod(tree);
  extraction.setClusterTolerance(tolerance_m);
  extraction.setMinClusterSize(static_cast<pcl::uindex_t>(min_count));
  extraction.setInputCloud(cloud);
  std::vector<pcl::PointIndices> found;
  extraction.extract(found);
  std::vector<Indices> out;
  for (const pcl::PointIndices& cluster : found) {
    out.emplace_back(cluster.indices.begin(), cluster.indices.end());
    std::sort(out.back().begin(), out.back().end());
  }
  std::sort(out.begin(), out.end());
  return out;
}

TEST(ClustersPclTest, ThePartitionIsTheSame) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    const Points points = RandomPoints(random, 3000, 0.2);
    for (const double tolerance : {0.008, 0.010, 0.015}) {
      for (const int min_count : {1, 20}) {
        const std::vector<Indices> theirs = PclClusters(points, tolerance, min_count);
        EXPECT_THAT(FindClusters(points, tolerance, static_cast<std::size_t>(min_count)),
                    ElementsAreArray(theirs))
            << "seed " << seed << " tolerance " << tolerance;
      }
    }
  }
}

}  // namespace
}  // namespace graspdb::recognition
