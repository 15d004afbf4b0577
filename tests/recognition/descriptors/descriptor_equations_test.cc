// Every equation of the paper on clouds whose angles are known in closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "recognition/descriptors/descriptor.h"
#include "tests/recognition/descriptors/described.h"
#include "tests/recognition/scenes/descriptor_parts.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::Bins;
using ::graspdb::testing::kAlpha;
using ::graspdb::testing::kBeta;
using ::graspdb::testing::kHalfTurn;
using ::graspdb::testing::kPhi;
using ::graspdb::testing::kTheta;
using ::graspdb::testing::kViewAlpha;
using ::graspdb::testing::kViewPhi;
using ::graspdb::testing::kViewTheta;
using ::graspdb::testing::Part;

constexpr double kDegree = kHalfTurn / 180;

// A normal by its components along the local directions of a ring about the z axis:
// outwards, along the ring (counter-clockwise from above), upwards.
struct RingNormal {
  double out;
  double along;
  double up;
};

// Adds `count` points of a ring of radius `radius` at height `z`.
void AddRing(int count, double radius, double z, const RingNormal& n, OrientedCloud* cloud) {
  for (int i = 0; i < count; ++i) {
    const double turn = 2 * kHalfTurn * i / count + 0.1;
    const Vector3d out(std::cos(turn), std::sin(turn), 0);
    const Vector3d along(-std::sin(turn), std::cos(turn), 0);
    const Vector3d normal = n.out * out + n.along * along + n.up * Vector3d::UnitZ();
    cloud->points.emplace_back(Vector3d(radius * out.x(), radius * out.y(), z).cast<float>());
    cloud->normals.emplace_back(normal.normalized().cast<float>());
  }
}

// A value that a share of the points has.
using Share = std::pair<double, double>;

// The part contains exactly these values; its whole mass is `mass`.
void ExpectPart(const Descriptor& descriptor, const Part& part, double mass,
                const std::vector<Share>& shares) {
  SCOPED_TRACE(part.name);
  std::vector<float> expected(part.size, 0.0F);
  for (const auto& [value, share] : shares) {
    const double bin =
        std::floor((value - part.lo) / (part.hi - part.lo) * static_cast<double>(part.size));
    expected[static_cast<std::size_t>(bin)] += static_cast<float>(share * mass);
  }
  EXPECT_THAT(Bins(descriptor, part), ::testing::Pointwise(::testing::FloatNear(1e-6F), expected));
}

// Two rings, 4 cm above and below the centroid, with a viewpoint 0.5 m above: n_c is
// the z axis by symmetry, and the normals have the same components everywhere.
class TwoRingsTest : public ::testing::Test {
 protected:
  TwoRingsTest() {
    AddRing(9, 0.03, 0.04, normal_, &cloud_);
    AddRing(9, 0.03, -0.04, normal_, &cloud_);
    vfh_ = Described(cloud_, viewpoint_, DescriptorKind::kVfh263);
    mvfh_ = Described(cloud_, viewpoint_, DescriptorKind::kMvfh300);
  }

  // 0.36^2 + 0.48^2 + 0.8^2 = 1.
  const RingNormal normal_{0.36, 0.48, 0.8};
  const Vector3d viewpoint_{0, 0, 0.5};
  OrientedCloud cloud_;
  Descriptor vfh_;
  Descriptor mvfh_;
};

// v = d x u = -along, by eqs. 1 and 2. Without the unit length of v, eq. 4 would give
// 0.48 * 0.6 and another bin: d leans 53 degrees against the plane of the ring.
TEST_F(TwoRingsTest, CosAlphaIsTheShareOfTheNormalAlongTheUnitAxisV) {
  ExpectPart(vfh_, kAlpha, 1.0 / 4, {{-0.48, 1}});
  ExpectPart(mvfh_, kAlpha, 1.0 / 6, {{-0.48, 1}});
  EXPECT_NEAR(vfh_[11], 0.25, 1e-6);  // (1 - 0.48) * 22.5 = 11.7
}

// d = (0.6 out, +-0.8 up), eq. 6: 0.6 * 0.36 +- 0.8 * 0.8.
TEST_F(TwoRingsTest, CosPhiIsTheShareOfTheNormalAwayFromTheCentroid) {
  ExpectPart(vfh_, kPhi, 1.0 / 4, {{0.856, 0.5}, {-0.424, 0.5}});
  ExpectPart(mvfh_, kPhi, 1.0 / 6, {{0.856, 0.5}, {-0.424, 0.5}});
}

// w = u x v = out, by eq. 3; eq. 7: atan2(0.36, 0.8). With v not normalised the first
// argument would be 0.36 * 0.6.
TEST_F(TwoRingsTest, ThetaIsTheAngleInThePlaneOfUAndTheUnitAxisW) {
  ExpectPart(vfh_, kTheta, 1.0 / 4, {{std::atan2(0.36, 0.8), 1}});
  ExpectPart(mvfh_, kTheta, 1.0 / 6, {{std::atan2(0.36, 0.8), 1}});
}

// Eq. 5 with the viewpoint on the axis: the upward component.
TEST_F(TwoRingsTest, CosBetaIsTheShareOfTheNormalTowardsTheViewpoint) {
  ExpectPart(vfh_, kBeta, 1.0 / 4, {{0.8, 1}});
}

// v_p - p_i points inwards and up, so V = +along (eqs. 8, 9). Not normalised it would
// be 0.03 long (or 0.06 with v_p - p_i of unit length) and eq. 11 would be about zero.
TEST_F(TwoRingsTest, ViewCosAlphaIsTheShareOfTheNormalAlongTheUnitAxisV) {
  ExpectPart(mvfh_, kViewAlpha, 1.0 / 6, {{0.48, 1}});
  EXPECT_NEAR(mvfh_[135 + 40], 1.0 / 6, 1e-6);  // (1 + 0.48) * 27.5 = 40.7
}

// Eq. 12 is eq. 6 in 55 bins.
TEST_F(TwoRingsTest, ViewCosPhiIsTheShareOfTheNormalAwayFromTheCentroid) {
  ExpectPart(mvfh_, kViewPhi, 1.0 / 6, {{0.856, 0.5}, {-0.424, 0.5}});
}

// W = U x V = -out (eq. 10), so eq. 13 turns the other way than eq. 7.
TEST_F(TwoRingsTest, ViewThetaIsTheAngleInThePlaneOfUAndTheUnitAxisW) {
  ExpectPart(mvfh_, kViewTheta, 1.0 / 6, {{std::atan2(-0.36, 0.8), 1}});
}

// Normals more than a right angle away from n_c: theta must be an angle of all four
// quadrants (eqs. 7 and 13), not an arctangent of the quotient.
TEST(DescriptorEquationsTest, ThetaPassesTheRightAngle) {
  OrientedCloud cloud;
  AddRing(6, 0.03, 0, {std::sin(130 * kDegree), 0, std::cos(130 * kDegree)}, &cloud);
  AddRing(18, 0.05, 0, {0, 0, 1}, &cloud);
  const Descriptor mvfh = Described(cloud, {0, 0, 0.5}, DescriptorKind::kMvfh300);
  ExpectPart(mvfh, kTheta, 1.0 / 6, {{130 * kDegree, 0.25}, {0, 0.75}});
  ExpectPart(mvfh, kViewTheta, 1.0 / 6, {{-130 * kDegree, 0.25}, {0, 0.75}});
}

// A far viewpoint, 50 degrees from n_c towards +x: V = -y and W = +x for every point.
// A third of the normals lean far to +y, two thirds half as much to -y, so that n_c
// stays upright and neither sign of eq. 11 could be taken for the other.
TEST(DescriptorEquationsTest, ViewAxesFollowTheViewpointAndNotThePoint) {
  OrientedCloud cloud;
  AddRing(30, 0.05, 0, {0, 0, 1}, &cloud);
  const double far_lean = 0.62;
  const double near_lean = 0.31;
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    const double y = i % 3 == 0 ? far_lean : -near_lean;
    cloud.normals[i] = Vector3d(0, y, std::sqrt(1 - y * y)).cast<float>();
  }
  const Vector3d viewpoint = 1e5 * Vector3d(std::sin(50 * kDegree), 0, std::cos(50 * kDegree));
  const Descriptor mvfh = Described(cloud, viewpoint, DescriptorKind::kMvfh300);
  ExpectPart(mvfh, kViewAlpha, 1.0 / 6, {{-far_lean, 1.0 / 3}, {near_lean, 2.0 / 3}});
  ExpectPart(mvfh, kViewTheta, 1.0 / 6, {{0, 1}});

  const double cos_beta = std::cos(50 * kDegree);
  ExpectPart(Described(cloud, viewpoint, DescriptorKind::kVfh263), kBeta, 1.0 / 4,
             {{cos_beta * std::sqrt(1 - far_lean * far_lean), 1.0 / 3},
              {cos_beta * std::sqrt(1 - near_lean * near_lean), 2.0 / 3}});
}

// Leaning in x instead shows the other axis: theta^M = atan2(N_x, N_z).
TEST(DescriptorEquationsTest, ViewThetaTurnsTowardsTheViewpoint) {
  OrientedCloud cloud;
  AddRing(30, 0.05, 0, {0, 0, 1}, &cloud);
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    const double x = i % 3 == 0 ? 0.62 : -0.31;
    cloud.normals[i] = Vector3d(x, 0, std::sqrt(1 - x * x)).cast<float>();
  }
  const Vector3d viewpoint = 1e5 * Vector3d(std::sin(50 * kDegree), 0, std::cos(50 * kDegree));
  const Descriptor mvfh = Described(cloud, viewpoint, DescriptorKind::kMvfh300);
  ExpectPart(mvfh, kViewAlpha, 1.0 / 6, {{0, 1}});
  ExpectPart(mvfh, kViewTheta, 1.0 / 6, {{std::asin(0.62), 1.0 / 3}, {std::asin(-0.31), 2.0 / 3}});
}

}  // namespace
}  // namespace graspdb::recognition
