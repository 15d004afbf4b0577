// Normals against the Point Cloud Library's.
#include <gtest/gtest.h>
#include <pcl/features/normal_3d.h>

#include <algorithm>
#include <cmath>

#include "recognition/points/normals.h"
#include "recognition/points/voxels.h"
#include "recognition/segmentation/outliers.h"
#include "tests/recognition/scenes/pcl_clouds.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPose;
using ::graspdb::testing::ToPcl;
using ::graspdb::testing::Uniform;
using ::graspdb::testing::WavySurface;

TEST(NormalsPclTest, AgreeOnNoisySurfacesAndFaceTheViewpoint) {
  const double radius = 0.01;
  double largest = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    const Pose pose = RandomPose(random, 0.3);
    Points points = graspdb::testing::Moved(pose, WavySurface(random, 3000)).points;
    for (auto& p : points) {
      for (float& x : p) x += static_cast<float>(Uniform(random, -0.001, 0.001));
    }
    const Eigen::Vector3d viewpoint = pose * Eigen::Vector3d(0.1, 0.2, 0.6);

    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(ToPcl(points));
    estimation.setRadiusSearch(radius);
    const Eigen::Vector3f v = viewpoint.cast<float>();
    estimation.setViewPoint(v.x(), v.y(), v.z());
    pcl::PointCloud<pcl::Normal> theirs;
    estimation.compute(theirs);

    const Normals ours = EstimateNormals(points, viewpoint, radius);
    ASSERT_EQ(ours.size(), theirs.size());
    for (std::size_t i = 0; i < ours.size(); ++i) {
      const Eigen::Vector3d a = ours[i].cast<double>();
      const Eigen::Vector3d b = theirs[i].getNormalVector3fMap().cast<double>();
      const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
      EXPECT_LT(angle, 1e-3) << "seed " << seed << " point " << i;
      largest = std::max(largest, angle);
    }
  }
  RecordProperty("largest_angle", std::to_string(largest));
}

}  // namespace
}  // namespace graspdb::recognition
