// Neither the order of the points nor where cloud and sensor are moved together
// changes a descriptor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>

#include "recognition/descriptors/descriptor.h"
#include "tests/recognition/descriptors/described.h"
#include "tests/recognition/scenes/chi_square.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::ChiSquareDistance;
using ::graspdb::testing::Moved;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPose;
using ::graspdb::testing::Reordered;
using ::graspdb::testing::Uniform;
using ::graspdb::testing::WavySurface;

constexpr float kTolerance = 1e-4F;

float LargestDifference(const Descriptor& a, const Descriptor& b) {
  float largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

using Case = std::tuple<DescriptorKind, std::size_t>;

class DescriptorInvarianceTest : public ::testing::TestWithParam<Case> {
 protected:
  // A new cloud and the sensor 0.4 to 0.8 m in front of it.
  void Prepare(std::uint64_t seed) {
    random_.seed(seed);
    cloud_ = WavySurface(random_, std::get<1>(GetParam()));
    viewpoint_ = {Uniform(random_, -0.3, 0.3), Uniform(random_, -0.3, 0.3),
                  Uniform(random_, 0.4, 0.8)};
  }

  const DescriptorKind kind_ = std::get<0>(GetParam());
  Random random_;
  OrientedCloud cloud_;
  Vector3d viewpoint_;
};

TEST_P(DescriptorInvarianceTest, OrderOfThePointsDoesNotMatter) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Prepare(seed);
    const Descriptor before = Described(cloud_, viewpoint_, kind_);
    const Descriptor after = Described(Reordered(random_, cloud_), viewpoint_, kind_);
    EXPECT_LE(LargestDifference(before, after), kTolerance) << "seed " << seed;
  }
}

TEST_P(DescriptorInvarianceTest, RigidMotionOfCloudAndSensorDoesNotMatter) {
  float largest = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Prepare(seed);
    const Pose motion = RandomPose(random_, 1.0);
    const Descriptor before = Described(cloud_, viewpoint_, kind_);
    const Descriptor after = Described(Moved(motion, cloud_), motion * viewpoint_, kind_);
    const float difference = LargestDifference(before, after);
    EXPECT_LE(difference, kTolerance) << "seed " << seed;
    largest = std::max(largest, difference);
  }
  RecordProperty("largest_difference", std::to_string(largest));
}

TEST_P(DescriptorInvarianceTest, MotionOfTheSensorAloneDoesMatter) {
  Prepare(1);
  const Descriptor right = Described(cloud_, {0.4, 0, 0.5}, kind_);
  const Descriptor behind = Described(cloud_, {0, 0.4, 0.5}, kind_);
  EXPECT_GT(ChiSquareDistance(right, behind), 0.05);
}

INSTANTIATE_TEST_SUITE_P(KindsAndSizes, DescriptorInvarianceTest,
                         ::testing::Combine(::testing::Values(DescriptorKind::kVfh263,
                                                              DescriptorKind::kMvfh300),
                                            ::testing::Values(300, 1000, 5000, 20000)));

// A symmetric cloud with one point on its centroid and one straight above, whose frames
// are not defined: rounding must not define them.
TEST(DescriptorInvarianceEdgeTest, PointsWithoutAFrameHaveNoneAfterARigidMotion) {
  OrientedCloud cloud;
  for (int i = 0; i < 24; ++i) {
    const double turn = 2 * std::numbers::pi * i / 24;
    const Vector3d out(std::cos(turn), std::sin(turn), 0);
    cloud.points.emplace_back((0.05 * out).cast<float>());
    cloud.normals.emplace_back((0.6 * out + 0.8 * Vector3d::UnitZ()).cast<float>());
  }
  for (const float z : {0.0F, 0.03F, -0.03F}) {
    cloud.points.emplace_back(0.0F, 0.0F, z);
    cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  const Vector3d viewpoint(0, 0, 0.6);
  Random random(11);
  for (const DescriptorKind kind : {DescriptorKind::kVfh263, DescriptorKind::kMvfh300}) {
    const Descriptor before = Described(cloud, viewpoint, kind);
    float largest = 0;
    for (int i = 0; i < 20; ++i) {
      const Pose motion = RandomPose(random, 1.0);
      const Descriptor after = Described(Moved(motion, cloud), motion * viewpoint, kind);
      largest = std::max(largest, LargestDifference(before, after));
    }
    EXPECT_LE(largest, kTolerance) << DescriptorName(kind);
  }
}

}  // namespace
}  // namespace graspdb::recognition
