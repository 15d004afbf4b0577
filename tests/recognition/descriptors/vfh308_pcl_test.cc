// VFH-308 bin by bin against the Point Cloud Library's.
#include <gtest/gtest.h>
#include <pcl/features/vfh.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "recognition/descriptors/descriptor.h"
#include "tests/recognition/scenes/pcd_file.h"
#include "tests/recognition/scenes/pcl_clouds.h"
#include "tests/recognition/scenes/shared_data.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Moved;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomDirection;
using ::graspdb::testing::RandomPoints;
using ::graspdb::testing::RandomPose;
using ::graspdb::testing::ReadPcd;
using ::graspdb::testing::SharedData;
using ::graspdb::testing::SharedDataMissing;
using ::graspdb::testing::ToPcl;
using ::graspdb::testing::ToPclNormals;
using ::graspdb::testing::WavySurface;

constexpr float kTotalMass = 400;  // four parts of a hundred

Descriptor PclVfh(const OrientedCloud& cloud, const Eigen::Vector3d& viewpoint) {
  pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> estimation;
  estimation.setInputCloud(ToPcl(cloud.points));
  estimation.setInputNormals(ToPclNormals(cloud.normals));
  const Eigen::Vector3f v = viewpoint.cast<float>();
  estimation.setViewPoint(v.x(), v.y(), v.z());
  pcl::PointCloud<pcl::VFHSignature308> out;
  estimation.compute(out);
  const float* bins = out.at(0).histogram;
  return {bins, bins + 308};
}

// The largest difference of a bin as a share of the whole mass.
float LargestDifference(const OrientedCloud& cloud, const Eigen::Vector3d& viewpoint) {
  const auto ours = Describe(cloud, viewpoint, DescriptorKind::kVfh308);
  EXPECT_TRUE(ours.ok()) << ours.status();
  if (!ours.ok()) return INFINITY;
  const Descriptor theirs = PclVfh(cloud, viewpoint);
  float largest = 0;
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    largest = std::max(largest, std::abs((*ours)[i] - theirs[i]));
  }
  return largest / kTotalMass;
}

TEST(Vfh308PclTest, AgreesOnSurfaces) {
  float largest = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const Pose pose = RandomPose(random, 0.5);
    const OrientedCloud cloud = Moved(pose, WavySurface(random, 200 + 300 * seed));
    largest = std::max(largest, LargestDifference(cloud, pose * Eigen::Vector3d(0.2, -0.1, 0.6)));
  }
  RecordProperty("largest_difference", std::to_string(largest));
  EXPECT_LE(largest, 1e-3F);
}

TEST(Vfh308PclTest, AgreesOnPointsWithNormalsOfAnyDirection) {
  float largest = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    OrientedCloud cloud;
    cloud.points = RandomPoints(random, 2000, 0.2);
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      cloud.normals.push_back(RandomDirection(random).cast<float>());
    }
    largest = std::max(largest, LargestDifference(cloud, {0, 0, 0}));
  }
  RecordProperty("largest_difference", std::to_string(largest));
  EXPECT_LE(largest, 1e-3F);
}

TEST(Vfh308PclTest, AgreesOnRealCloudsWithTheirOwnNormals) {
  const auto folder = SharedData("vfh_turntable");
  if (!folder) GTEST_SKIP() << SharedDataMissing("vfh_turntable");
  std::ifstream index(*folder / "index.csv");
  std::string line;
  std::getline(index, line);  // the header
  int count = 0;
  float largest = 0;
  while (std::getline(index, line)) {
    std::stringstream fields(line);
    std::string object;
    std::string file;
    std::getline(fields, object, ',');
    std::getline(fields, file, ',');
    const OrientedCloud cloud = ReadPcd(*folder / file).cloud;
    const float difference = LargestDifference(cloud, {0, 0, 0});
    EXPECT_LE(difference, 1e-3F) << file;
    largest = std::max(largest, difference);
    ++count;
  }
  RecordProperty("largest_difference", std::to_string(largest));
  EXPECT_GE(count, 80);
}

}  // namespace
}  // namespace graspdb::recognition
