#include "recognition/segmentation/segmented_points.h"

#include <gtest/gtest.h>

#include <limits>

#include "recognition/points/voxels.h"
#include "recognition/segmentation/segmentation.h"
#include "tests/recognition/scenes/synthetic_clouds.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPose;
using ::graspdb::testing::WavySurface;

class SegmentedPointsTest : public ::testing::Test {
 protected:
  SegmentedPointsTest() {
    Random random(3);
    for (const Eigen::Vector3f& p : WavySurface(random, 2000).points) {
      scan_.points.emplace_back(p + Eigen::Vector3f(0, 0, 0.7F));
    }
    scan_.segmented = true;
  }

  std::optional<Indices> Found() const {
    return SegmentedPoints(scan_, parameters_, DescriptorParameters().voxel_size_m,
                           [] { return false; });
  }

  Segmentation Segmented() const {
    StageLog log;
    auto out = SegmentScan(
        scan_, parameters_, {}, [] { return false; }, &log);
    EXPECT_THAT(out, IsOk());
    return out.ok() ? *std::move(out) : Segmentation();
  }

  void ExpectThoseOfTheSegment() const {
    const std::optional<Indices> found = Found();
    const Segmentation whole = Segmented();
    ASSERT_TRUE(found.has_value());
    ASSERT_EQ(whole.segments.size(), 1U);
    EXPECT_EQ(*found, whole.segments.front().indices);
    EXPECT_FALSE(whole.segments.front().too_large);
    EXPECT_EQ(whole.far_point_count, 0U);
  }

  Scan scan_;
  SegmentationParameters parameters_;
};

TEST_F(SegmentedPointsTest, AreThoseOfTheSegment) {
  ExpectThoseOfTheSegment();
  Random random(4);
  scan_.world_sensor = RandomPose(random, 1);
  ExpectThoseOfTheSegment();
}

TEST_F(SegmentedPointsTest, LeaveOutWhatTheSegmentLeavesOut) {
  scan_.points[3] = Eigen::Vector3f::Zero();
  scan_.points[7] = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  scan_.points[9].z() = 30;  // out of range
  scan_.region = Box{{-1, -1, 0}, {0.02, 1, 50}};
  ExpectThoseOfTheSegment();
  EXPECT_LT(Found()->size(), 1900U);
}

TEST_F(SegmentedPointsTest, AreAbsentWithTooFewVoxels) {
  const double edge_m = DescriptorParameters().voxel_size_m;
  const auto voxels = static_cast<int>(DownsampleToVoxels(scan_.points, edge_m).points.size());
  parameters_.min_cluster_point_count = voxels;
  ExpectThoseOfTheSegment();
  parameters_.min_cluster_point_count = voxels + 1;
  EXPECT_FALSE(Found().has_value());
  EXPECT_TRUE(Segmented().segments.empty());
}

TEST_F(SegmentedPointsTest, AreAbsentWithTooLargeAnObject) {
  scan_.points[5].x() = 1.5F;
  EXPECT_FALSE(Found().has_value());
}

TEST_F(SegmentedPointsTest, AreAbsentWithoutAMeasurement) {
  for (Eigen::Vector3f& p : scan_.points) p.setZero();
  EXPECT_FALSE(Found().has_value());
  scan_.points.clear();
  EXPECT_FALSE(Found().has_value());
}

TEST_F(SegmentedPointsTest, AreAbsentOfAWholeScan) {
  scan_.segmented = false;
  EXPECT_FALSE(Found().has_value());
}

TEST_F(SegmentedPointsTest, AreAbsentOnceCancelled) {
  EXPECT_FALSE(SegmentedPoints(scan_, {}, 0.003, [] { return true; }).has_value());
}

}  // namespace
}  // namespace graspdb::recognition
