#include "recognition/descriptors/gsh288.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "recognition/segmentation/segmentation.h"
#include "tests/recognition/scenes/chi_square.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::ChiSquareDistance;
using ::graspdb::testing::Moved;
using ::graspdb::testing::Random;
using ::graspdb::testing::Reordered;
using ::graspdb::testing::Uniform;
using ::graspdb::testing::WavySurface;

Pose At(const Vector3d& eye) { return Pose(Eigen::Translation3d(eye)); }
Pose Eye() { return At({0.1, -0.6, 0.5}); }

Pose YawPose(double deg) {
  return Pose(Eigen::AngleAxisd(deg * std::numbers::pi / 180, Vector3d::UnitZ()));
}

float LargestBinDifference(const Descriptor& a, const Descriptor& b) {
  float largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// A flat face that stands upright, 10 cm wide and 5 cm high, and looks towards -y.
OrientedCloud Face() {
  Random random(4);
  OrientedCloud face;
  for (int i = 0; i < 1000; ++i) {
    face.points.emplace_back(
        Vector3d(Uniform(random, -0.05, 0.05), 0, Uniform(random, 0, 0.05)).cast<float>());
    face.normals.emplace_back(0.0F, -1.0F, 0.0F);
  }
  return face;
}

TEST(Gsh288, EveryPartHasAThirdOfTheMass) {
  Random random(1);
  const Descriptor bins = DescribeGsh288(WavySurface(random, 700), Eye());
  ASSERT_EQ(bins.size(), 288U);
  for (std::size_t part = 0; part < 3; ++part) {
    double mass = 0;
    for (std::size_t i = 0; i < 96; ++i) mass += static_cast<double>(bins[96 * part + i]);
    EXPECT_NEAR(mass, 1.0 / 3, 1e-5) << part;
  }
}

TEST(Gsh288, OrderPlaceAndATurnAboutTheVerticalDoNotMatter) {
  Random random(2);
  const OrientedCloud cloud = WavySurface(random, 2000);
  const Descriptor before = DescribeGsh288(cloud, Eye());
  EXPECT_LT(LargestBinDifference(before, DescribeGsh288(Reordered(random, cloud), Eye())), 1e-6F);
  for (const double deg : {3.0, 90.0, 200.0}) {
    Pose motion = YawPose(deg);
    motion.translation() = Vector3d(0.3, -0.2, 0.05);
    const Descriptor after = DescribeGsh288(Moved(motion, cloud), motion * Eye());
    EXPECT_LT(LargestBinDifference(before, after), 1e-5F) << deg;
  }
}

// VFH and MVFH cannot distinguish them: all normals of a flat face are alike.
TEST(Gsh288, AFlatFaceIsNotItsMirrorImage) {
  const Pose eye = At({0, -0.6, 0.4});
  const Descriptor left = DescribeGsh288(Moved(YawPose(30), Face()), eye);
  const Descriptor right = DescribeGsh288(Moved(YawPose(-30), Face()), eye);
  EXPECT_GT(ChiSquareDistance(left, right), 0.5);
}

// A small turn moves a count gradually from bin to bin.
TEST(Gsh288, ASmallTurnIsASmallDistance) {
  Random random(3);
  const OrientedCloud cloud = WavySurface(random, 2000);
  const Descriptor before = DescribeGsh288(cloud, Eye());
  const double near = ChiSquareDistance(before, DescribeGsh288(Moved(YawPose(1), cloud), Eye()));
  const double far = ChiSquareDistance(before, DescribeGsh288(Moved(YawPose(15), cloud), Eye()));
  EXPECT_LT(near, 0.1 * far);
}

// A camera straight above, a little off the centre to one side or the other: its view is the same.
TEST(Gsh288, FromAboveTheCamerasSideDoesNotMatter) {
  const OrientedCloud face = Face();
  Pose above(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()));  // looks down
  above.translation() = Centroid(face.points) + Vector3d(0.02, 0, 0.5);
  const Descriptor from_x = DescribeGsh288(face, above);
  above.translation().x() -= 0.04;
  EXPECT_LT(LargestBinDifference(from_x, DescribeGsh288(face, above)), 1e-6F);
  above.rotate(Eigen::AngleAxisd(0.5, Vector3d::UnitZ()));
  EXPECT_GT(ChiSquareDistance(from_x, DescribeGsh288(face, above)), 0.1) << "the image has turned";
}

}  // namespace
}  // namespace graspdb::recognition
