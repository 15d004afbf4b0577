// Mirrored poses, which MVFH distinguishes and VFH does not.
//
// Under a mirror v = d x u changes its sign and w = u x v does not. So cos(alpha) and
// cos(alpha^M) are turned round, and every other angle keeps its histogram.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "recognition/descriptors/descriptor.h"
#include "tests/recognition/descriptors/described.h"
#include "tests/recognition/scenes/chi_square.h"
#include "tests/recognition/scenes/descriptor_parts.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::Bins;
using ::graspdb::testing::ChiSquareDistance;
using ::graspdb::testing::kAlpha;
using ::graspdb::testing::kBeta;
using ::graspdb::testing::kPhi;
using ::graspdb::testing::kTheta;
using ::graspdb::testing::kViewAlpha;
using ::graspdb::testing::kViewPhi;
using ::graspdb::testing::kViewTheta;
using ::graspdb::testing::MirroredInX;
using ::graspdb::testing::Random;
using ::graspdb::testing::Uniform;
using ::graspdb::testing::WavySurface;

std::vector<float> TurnedRound(std::vector<float> bins) {
  std::reverse(bins.begin(), bins.end());
  return bins;
}

auto Equals(const std::vector<float>& bins) {
  return ::testing::Pointwise(::testing::FloatNear(1e-5F), bins);
}

// The viewpoint turned by `yaw_deg` about the y axis from straight above the origin.
Vector3d YawedViewpoint(double yaw_deg) {
  const double yaw = yaw_deg * std::numbers::pi / 180;
  return 0.6 * Vector3d(std::sin(yaw), 0, std::cos(yaw));
}

// An asymmetric cloud and its mirror image at x = 0, with the centroid moved into that plane so
// that it contains the line of sight.
class MirrorImageTest : public ::testing::Test {
 protected:
  MirrorImageTest() {
    Random random(21);
    cloud_ = WavySurface(random, 3000);
    double x = 0;
    for (const auto& p : cloud_.points) x += p.x();
    x /= static_cast<double>(cloud_.points.size());
    for (auto& p : cloud_.points) p.x() -= static_cast<float>(x);
    mirrored_ = MirroredInX(cloud_);
  }

  const Vector3d viewpoint_{0, -0.3, 0.5};
  OrientedCloud cloud_;
  OrientedCloud mirrored_;
};

TEST_F(MirrorImageTest, CosAlphaOfBothFramesIsTurnedRound) {
  const Descriptor before = Described(cloud_, viewpoint_, DescriptorKind::kMvfh300);
  const Descriptor after = Described(mirrored_, viewpoint_, DescriptorKind::kMvfh300);
  EXPECT_THAT(Bins(after, kAlpha), Equals(TurnedRound(Bins(before, kAlpha))));
  EXPECT_THAT(Bins(after, kViewAlpha), Equals(TurnedRound(Bins(before, kViewAlpha))));
  EXPECT_THAT(Bins(after, kViewAlpha), ::testing::Not(Equals(Bins(before, kViewAlpha))));
}

TEST_F(MirrorImageTest, EveryOtherPartOfMvfhStays) {
  const Descriptor before = Described(cloud_, viewpoint_, DescriptorKind::kMvfh300);
  const Descriptor after = Described(mirrored_, viewpoint_, DescriptorKind::kMvfh300);
  for (const auto& part : {kPhi, kTheta, kViewPhi, kViewTheta}) {
    EXPECT_THAT(Bins(after, part), Equals(Bins(before, part))) << part.name;
  }
}

TEST_F(MirrorImageTest, ViewpointPartOfVfhStaysWhileThatOfMvfhChanges) {
  const Descriptor vfh = Described(cloud_, viewpoint_, DescriptorKind::kVfh263);
  const Descriptor vfh_mirrored = Described(mirrored_, viewpoint_, DescriptorKind::kVfh263);
  EXPECT_LT(ChiSquareDistance(Bins(vfh, kBeta), Bins(vfh_mirrored, kBeta)), 1e-5);
  const Descriptor mvfh = Described(cloud_, viewpoint_, DescriptorKind::kMvfh300);
  const Descriptor mvfh_mirrored = Described(mirrored_, viewpoint_, DescriptorKind::kMvfh300);
  EXPECT_GT(ChiSquareDistance(Bins(mvfh, kViewAlpha), Bins(mvfh_mirrored, kViewAlpha)), 0.01);
}

// A roof whose ridge runs along x: left and right alike, a short steep slope on one side
// and a long gentle one on the other.
OrientedCloud LopsidedRoof() {
  Random random(3);
  OrientedCloud cloud;
  const auto add = [&](double x, double y, double z, const Vector3d& normal) {
    for (const double side : {-1.0, 1.0}) {
      cloud.points.emplace_back(Vector3d(side * x, y, z).cast<float>());
      cloud.normals.emplace_back(normal.normalized().cast<float>());
    }
  };
  for (int i = 0; i < 1000; ++i) {
    const double x = Uniform(random, 0, 0.06);
    const double y = Uniform(random, -0.02, 0.06);
    if (y < 0) {
      add(x, y, 1.5 * y, {0, -1.5, 1});
    } else {
      add(x, y, -0.4 * y, {0, 0.4, 1});
    }
  }
  return cloud;
}

// Figure 9b and 9c of the paper.
TEST(YawTest, MvfhDistinguishesYawPlus30FromMinus30AndVfhDoesNot) {
  const OrientedCloud roof = LopsidedRoof();
  const auto distance = [&](DescriptorKind kind) {
    return ChiSquareDistance(Described(roof, YawedViewpoint(30), kind),
                             Described(roof, YawedViewpoint(-30), kind));
  };
  EXPECT_LT(distance(DescriptorKind::kVfh263), 1e-5);
  EXPECT_GT(distance(DescriptorKind::kMvfh300), 0.2);
}

TEST(YawTest, BothDistinguishYawPlus30FromNoYaw) {
  const OrientedCloud roof = LopsidedRoof();
  for (const DescriptorKind kind : {DescriptorKind::kVfh263, DescriptorKind::kMvfh300}) {
    EXPECT_GT(ChiSquareDistance(Described(roof, YawedViewpoint(30), kind),
                                Described(roof, YawedViewpoint(0), kind)),
              0.1);
  }
}

// A known limitation, and the reason why candidates are verified: on a flat face all
// normals are n_c, so that every angle of MVFH is the same whatever the yaw. Only VFH's
// cos(beta) sees the yaw, and that without its sign.
TEST(YawTest, FlatFaceLooksTheSameToMvfhFromEverywhere) {
  Random random(4);
  OrientedCloud face;
  for (int i = 0; i < 1000; ++i) {
    face.points.emplace_back(
        Vector3d(Uniform(random, -0.05, 0.05), Uniform(random, -0.02, 0.03), 0).cast<float>());
    face.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  const auto distance = [&](DescriptorKind kind, double yaw_a, double yaw_b) {
    return ChiSquareDistance(Described(face, YawedViewpoint(yaw_a), kind),
                             Described(face, YawedViewpoint(yaw_b), kind));
  };
  EXPECT_LT(distance(DescriptorKind::kMvfh300, 30, -30), 1e-5);
  EXPECT_LT(distance(DescriptorKind::kMvfh300, 30, 0), 1e-5);
  EXPECT_GT(distance(DescriptorKind::kVfh263, 30, 0), 0.4);
}

}  // namespace
}  // namespace graspdb::recognition
