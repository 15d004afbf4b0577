// Degenerate inputs of the equations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "recognition/descriptors/descriptor.h"
#include "tests/recognition/scenes/descriptor_parts.h"
#include "tests/recognition/scenes/synthetic_clouds.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::Bins;
using ::graspdb::testing::kAlpha;
using ::graspdb::testing::kBeta;
using ::graspdb::testing::kPhi;
using ::graspdb::testing::kTheta;
using ::graspdb::testing::kViewAlpha;
using ::graspdb::testing::kViewPhi;
using ::graspdb::testing::kViewTheta;
using ::graspdb::testing::Mass;
using ::graspdb::testing::StatusIs;
using ::testing::HasSubstr;

class DescriptorDegenerateTest : public ::testing::TestWithParam<DescriptorKind> {
 protected:
  absl::StatusOr<Descriptor> DescribeIt(const OrientedCloud& cloud, const Vector3d& viewpoint) {
    return Describe(cloud, viewpoint, GetParam());
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, DescriptorDegenerateTest,
                         ::testing::Values(DescriptorKind::kVfh263, DescriptorKind::kMvfh300,
                                           DescriptorKind::kVfh308, DescriptorKind::kGsh288),
                         [](const auto& kind) { return std::string(DescriptorName(kind.param)); });

// 12 points on a circle of 5 cm about the origin.
OrientedCloud Ring(const std::function<Vector3d(int, const Vector3d&)>& normal) {
  OrientedCloud cloud;
  for (int i = 0; i < 12; ++i) {
    const double turn = std::numbers::pi * i / 6;
    const Vector3d out(std::cos(turn), std::sin(turn), 0);
    cloud.points.emplace_back((0.05 * out).cast<float>());
    cloud.normals.emplace_back(normal(i, out).cast<float>());
  }
  return cloud;
}

OrientedCloud UprightRing() {
  return Ring([](int, const Vector3d&) { return Vector3d::UnitZ(); });
}

// Normals outwards and inwards by turns: their mean has no length.
OrientedCloud BalancedRing() {
  return Ring([](int i, const Vector3d& out) { return Vector3d(i % 2 == 0 ? out : -out); });
}

void ExpectFinite(const absl::StatusOr<Descriptor>& descriptor) {
  ASSERT_TRUE(descriptor.ok()) << descriptor.status();
  EXPECT_TRUE(std::ranges::all_of(*descriptor, [](float x) { return std::isfinite(x) && x >= 0; }));
  EXPECT_GT(Mass(*descriptor), 0);
}

TEST_P(DescriptorDegenerateTest, FewerThanTenPointsHaveNoDescriptor) {
  OrientedCloud cloud = UprightRing();
  for (std::size_t count = 0; count < 10; ++count) {
    OrientedCloud few = cloud;
    few.points.resize(count);
    few.normals.resize(count);
    EXPECT_THAT(DescribeIt(few, {0, 0, 0.5}),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("at least 10")))
        << count;
  }
  cloud.points.resize(10);
  cloud.normals.resize(10);
  ExpectFinite(DescribeIt(cloud, {0, 0, 0.5}));
}

TEST_P(DescriptorDegenerateTest, CoincidentPointsHaveNoDescriptor) {
  const OrientedCloud cloud{Points(50, {0.1F, 0.2F, 0.3F}), Normals(50, {0, 0, 1})};
  EXPECT_THAT(DescribeIt(cloud, {0, 0, 0.5}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("all points coincide")));
}

TEST_P(DescriptorDegenerateTest, PointWithoutANormalIsRejected) {
  OrientedCloud cloud = UprightRing();
  cloud.normals.pop_back();
  EXPECT_THAT(DescribeIt(cloud, {0, 0, 0.5}), StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST_P(DescriptorDegenerateTest, NonFiniteValuesAreRejected) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  OrientedCloud point = UprightRing();
  point.points[3].y() = nan;
  EXPECT_THAT(DescribeIt(point, {0, 0, 0.5}), StatusIs(absl::StatusCode::kInvalidArgument));
  OrientedCloud normal = UprightRing();
  normal.normals[3].y() = nan;
  EXPECT_THAT(DescribeIt(normal, {0, 0, 0.5}), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(DescribeIt(UprightRing(), {0, 0, std::numeric_limits<double>::infinity()}),
              StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST_P(DescriptorDegenerateTest, DegenerateCloudsHaveFiniteDescriptors) {
  const Vector3d above(0, 0, 0.5);
  const Vector3d centroid = Vector3d::Zero();
  ExpectFinite(DescribeIt(BalancedRing(), above));
  ExpectFinite(DescribeIt(BalancedRing(), centroid));
  ExpectFinite(DescribeIt(UprightRing(), centroid));
  ExpectFinite(DescribeIt(UprightRing(), UprightRing().points[0].cast<double>()));
  ExpectFinite(DescribeIt(Ring([](int, const Vector3d& out) { return out; }), above));
}

// The direction to the viewpoint replaces the mean normal: u = z, w = out.
TEST(DescriptorWithoutMeanNormalTest, DirectionToTheViewpointReplacesIt) {
  const auto mvfh = Describe(BalancedRing(), {0, 0, 0.5}, DescriptorKind::kMvfh300);
  ASSERT_TRUE(mvfh.ok());
  EXPECT_NEAR(Mass(*mvfh), 1, 1e-5);
  EXPECT_NEAR(Bins(*mvfh, kAlpha)[22], 1.0 / 6, 1e-6);
  const std::vector<float> theta = Bins(*mvfh, kTheta);  // atan2(+-1, 0)
  EXPECT_NEAR(theta[11], 1.0 / 12, 1e-6);
  EXPECT_NEAR(theta[33], 1.0 / 12, 1e-6);
}

TEST(PointOnTheCentroidTest, CountsInThePartsThatNeedNoDirectionAlone) {
  OrientedCloud cloud = UprightRing();
  cloud.points.emplace_back(0.0F, 0.0F, 0.0F);
  cloud.normals.emplace_back(1.0F, 0.0F, 0.0F);
  cloud.points.emplace_back(0.0F, 0.0F, 0.0F);
  cloud.normals.emplace_back(-1.0F, 0.0F, 0.0F);
  const auto vfh = Describe(cloud, {0, 0, 0.5}, DescriptorKind::kVfh263);
  ASSERT_TRUE(vfh.ok());
  EXPECT_NEAR(Mass(*vfh), 1, 1e-5);
  EXPECT_NEAR(Bins(*vfh, kPhi)[22], 0.25, 1e-6);              // the ring alone
  EXPECT_NEAR(Bins(*vfh, kBeta)[127], 0.25 * 12 / 14, 1e-6);  // all fourteen
}

TEST(PointsAlongTheMeanNormalTest, PartsWithoutAFrameStayEmpty) {
  OrientedCloud cloud;
  for (int i = 0; i < 20; ++i) {
    cloud.points.emplace_back(0.0F, 0.0F, 0.01F * static_cast<float>(i) + 0.003F);
    cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  const auto mvfh = Describe(cloud, {0, 0, 1}, DescriptorKind::kMvfh300);
  ASSERT_TRUE(mvfh.ok());
  for (const auto& part : {kAlpha, kTheta, kViewAlpha, kViewTheta}) {
    EXPECT_EQ(Mass(Bins(*mvfh, part)), 0) << part.name;
  }
  for (const auto& part : {kPhi, kViewPhi}) {
    EXPECT_NEAR(Bins(*mvfh, part).front(), 1.0 / 12, 1e-6) << part.name;
    EXPECT_NEAR(Bins(*mvfh, part).back(), 1.0 / 12, 1e-6) << part.name;
  }
}

TEST(ViewpointOnTheCentroidTest, CosBetaIsThatOfNoDirection) {
  const auto vfh = Describe(UprightRing(), {0, 0, 0}, DescriptorKind::kVfh263);
  ASSERT_TRUE(vfh.ok());
  EXPECT_NEAR(Mass(*vfh), 1, 1e-5);
  const std::vector<float> beta = Bins(*vfh, kBeta);
  EXPECT_NEAR(beta[63] + beta[64], 0.25, 1e-6);
}

}  // namespace
}  // namespace graspdb::recognition
