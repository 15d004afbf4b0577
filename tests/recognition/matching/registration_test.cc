#include "recognition/matching/registration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "recognition/base/units.h"
#include "recognition/segmentation/segmentation.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::Moved;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomMotion;
using ::graspdb::testing::Uniform;
using ::graspdb::testing::WavySurface;

double Turn(const Pose& pose) { return std::abs(Eigen::AngleAxisd(pose.linear()).angle()); }

class RegistrationTest : public ::testing::Test {
 protected:
  Registration AlignWith(const OrientedCloud& target, const Points& source,
                         const Pose& initial = Pose::Identity()) const {
    const PointSearch search(target.points);
    return Align(source, {target, search}, initial, parameters_);
  }

  Random random_{31};
  MatchingParameters parameters_;
};

TEST_F(RegistrationTest, KnownMotionsAreRecovered) {
  parameters_.icp_iteration_count = 300;
  const OrientedCloud source = WavySurface(random_, 2000);
  const Vector3d center = Centroid(source.points);
  for (int i = 0; i < 8; ++i) {
    const Pose truth = RandomMotion(random_, center, 6 * kRadiansPerDegree, 0.004);
    const Registration found = AlignWith(Moved(truth, source), source.points);
    const Pose error = truth.inverse() * found.target_source;
    EXPECT_TRUE(found.converged) << i;
    EXPECT_LT((error * center - center).norm(), 1e-4) << i;
    EXPECT_LT(Turn(error), 0.05 * kRadiansPerDegree) << i;
    EXPECT_LT(found.rms_error_m, 1e-4) << i;
    EXPECT_DOUBLE_EQ(found.inlier_fraction, 1) << i;
    EXPECT_GT(found.iterations, 0) << i;
  }
}

TEST_F(RegistrationTest, InitialPoseIsWhereTheAlignmentBegins) {
  const OrientedCloud source = WavySurface(random_, 1500);
  const Pose truth = ::graspdb::testing::RandomPose(random_, 1.0);
  const OrientedCloud target = Moved(truth, source);
  const Registration found = AlignWith(target, source.points, truth);
  EXPECT_TRUE(found.converged);
  EXPECT_TRUE(found.target_source.isApprox(truth, 1e-5));
  EXPECT_LE(found.iterations, 3);
}

// A part of the source has no counterpart, as when the scan's object is partly hidden: the rest
// must decide.
TEST_F(RegistrationTest, PointsWithoutCounterpartDoNotMoveThePose) {
  parameters_.icp_iteration_count = 100;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    random_.seed(seed);
    const OrientedCloud source = WavySurface(random_, 3000);
    const Pose truth = RandomMotion(random_, Centroid(source.points), 3 * kRadiansPerDegree, 0.003);
    const OrientedCloud moved = Moved(truth, source);
    OrientedCloud target;
    for (std::size_t i = 0; i < source.points.size(); ++i) {
      if (source.points[i].x() < 0.015F) continue;
      target.points.push_back(moved.points[i]);
      target.normals.push_back(moved.normals[i]);
    }
    const Registration found = AlignWith(target, source.points);
    const Pose error = truth.inverse() * found.target_source;
    for (const double x : {-0.06, 0.06}) {
      const Vector3d end(x, 0, 0);
      EXPECT_LT((error * end - end).norm(), 0.001) << "seed " << seed;
    }
    const double share = static_cast<double>(target.points.size()) / 3000;
    EXPECT_NEAR(found.inlier_fraction, share, 0.08) << "seed " << seed;
  }
}

TEST_F(RegistrationTest, PlaneIsLevelledAndStaysInPlace) {
  OrientedCloud target;
  Points source;
  for (int i = 0; i < 1500; ++i) {
    target.points.emplace_back(
        Vector3d(Uniform(random_, -0.06, 0.06), Uniform(random_, -0.06, 0.06), 0).cast<float>());
    target.normals.emplace_back(0.0F, 0.0F, 1.0F);
    source.emplace_back(
        Vector3d(Uniform(random_, -0.05, 0.05), Uniform(random_, -0.05, 0.05), 0).cast<float>());
  }
  const Pose tilted = RandomMotion(random_, Vector3d::Zero(), 3 * kRadiansPerDegree, 0.004);
  const Registration found = AlignWith(target, source, tilted);
  ASSERT_TRUE(found.target_source.matrix().allFinite());
  EXPECT_LT(std::abs(found.target_source.translation().z()), 2e-4);
  EXPECT_LT(std::acos(std::min(1.0, found.target_source.linear()(2, 2))), 0.2 * kRadiansPerDegree);
  EXPECT_LT(found.target_source.translation().norm(), 0.01);
  EXPECT_LT(Turn(found.target_source), 5 * kRadiansPerDegree);
}

TEST_F(RegistrationTest, PointsOnALineStayFinite) {
  OrientedCloud target;
  for (int i = 0; i < 100; ++i) {
    target.points.emplace_back(0.001F * static_cast<float>(i), 0.0F, 0.0F);
    target.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  const Registration found = AlignWith(target, target.points);
  EXPECT_TRUE(found.target_source.matrix().allFinite());
  EXPECT_LT((found.target_source * Vector3d(0.05, 0, 0) - Vector3d(0.05, 0, 0)).norm(), 1e-3);
}

TEST_F(RegistrationTest, WithoutOverlapReturnsTheInitialPose) {
  const OrientedCloud cloud = WavySurface(random_, 500);
  Pose away = Pose::Identity();
  away.translation() = Vector3d(0, 0, 1);
  const Registration found = AlignWith(cloud, cloud.points, away);
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.iterations, 0);
  EXPECT_EQ(found.target_source.matrix(), away.matrix());
  EXPECT_EQ(found.inlier_fraction, 0);
  EXPECT_EQ(found.rms_error_m, 0);
}

TEST_F(RegistrationTest, EmptyInputIsNotConverged) {
  const OrientedCloud cloud = WavySurface(random_, 500);
  EXPECT_FALSE(AlignWith(cloud, {}).converged);
  EXPECT_FALSE(AlignWith({}, cloud.points).converged);
  EXPECT_TRUE(AlignWith({}, cloud.points).target_source.isApprox(Pose::Identity()));
}

TEST_F(RegistrationTest, TooFewIterationsAreNotConverged) {
  parameters_.icp_iteration_count = 1;
  const OrientedCloud source = WavySurface(random_, 1000);
  const Pose truth = RandomMotion(random_, Centroid(source.points), 6 * kRadiansPerDegree, 0.004);
  const Registration found = AlignWith(Moved(truth, source), source.points);
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.iterations, 1);
}

TEST_F(RegistrationTest, SameInputGivesTheSameBits) {
  const OrientedCloud source = WavySurface(random_, 1000);
  const Pose truth = RandomMotion(random_, Centroid(source.points), 6 * kRadiansPerDegree, 0.004);
  const OrientedCloud target = Moved(truth, source);
  const Registration first = AlignWith(target, source.points);
  const Registration again = AlignWith(target, source.points);
  EXPECT_EQ(first.target_source.matrix(), again.target_source.matrix());
  EXPECT_EQ(first.rms_error_m, again.rms_error_m);
  EXPECT_EQ(first.iterations, again.iterations);
}

TEST(SupportTest, FallsFromOneToZeroWithTheDistance) {
  const PointSearch search(Points{{0, 0, 0}});
  EXPECT_DOUBLE_EQ(Support({{0, 0, 0}}, search, 0.008), 1);
  EXPECT_NEAR(Support({{0.004F, 0, 0}}, search, 0.008), 0.75, 1e-6);
  EXPECT_NEAR(Support({{0.008F, 0, 0}}, search, 0.008), 0, 1e-6);
  EXPECT_EQ(Support({{1, 0, 0}}, search, 0.008), 0);
  EXPECT_NEAR(Support({{0, 0, 0}, {1, 0, 0}}, search, 0.008), 0.5, 1e-12);
}

TEST(SupportTest, NothingSupportsNothing) {
  EXPECT_EQ(Support({}, PointSearch(Points{{0, 0, 0}}), 0.008), 0);
  EXPECT_EQ(Support({{0, 0, 0}}, PointSearch(Points{}), 0.008), 0);
}

}  // namespace
}  // namespace graspdb::recognition
