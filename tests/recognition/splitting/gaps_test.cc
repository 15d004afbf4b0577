#include "recognition/splitting/gaps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb::recognition {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kVoxelM = 0.003;
constexpr std::size_t kMinCount = 20;

// A segment on the table z = 0, of blocks of voxels.
class SplitAtGapsTest : public ::testing::Test {
 protected:
  SplitAtGapsTest() {
    seen_.table = Plane{};
    seen_.table_reach_m = 0.003;
  }

  // Voxels from `from_m` to `to_m` along x, 3 cm wide, up to a height.
  void Block(double from_m, double to_m, double bottom_m, double top_m) {
    for (double x = from_m; x < to_m; x += kVoxelM) {
      for (double y = 0; y < 0.03; y += kVoxelM) {
        for (double z = bottom_m; z < top_m; z += kVoxelM) {
          whole_.cloud.points.push_back(Eigen::Vector3d(x, y, z).cast<float>());
          whole_.cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
        }
      }
    }
  }

  std::vector<Segment> Split() {
    scan_.points = whole_.cloud.points;
    for (std::size_t i = 0; i < scan_.points.size(); ++i) {
      whole_.indices.push_back(static_cast<std::int32_t>(i));
    }
    return SplitAtGaps({scan_, seen_, whole_}, kVoxelM, kMinCount);
  }

  Scan scan_;
  Segmentation seen_;
  Segment whole_;
};

TEST_F(SplitAtGapsTest, ABridgeLowOverTheTableConnectsNothing) {
  Block(0, 0.03, 0.004, 0.04);
  Block(0.03, 0.06, 0.004, 0.006);  // the bridge
  Block(0.06, 0.09, 0.004, 0.04);
  const auto parts = Split();
  ASSERT_THAT(parts, SizeIs(2));
  for (const Segment& part : parts) {
    EXPECT_EQ(part.cloud.points.size(), part.cloud.normals.size());
    EXPECT_EQ(part.cloud.points.size(), part.indices.size());
    EXPECT_GT(part.cloud.points.size(), 1200U);
  }
  EXPECT_LT(parts[0].centroid.x(), 0.03);
  EXPECT_GT(parts[1].centroid.x(), 0.06);
  // The bridge's middle belongs to no part, its ends to the blocks.
  const std::size_t sum = parts[0].cloud.points.size() + parts[1].cloud.points.size();
  EXPECT_LT(sum, whole_.cloud.points.size());
}

TEST_F(SplitAtGapsTest, AHighBridgeIsPartOfTheObject) {
  Block(0, 0.03, 0.004, 0.04);
  Block(0.03, 0.06, 0.004, 0.015);
  Block(0.06, 0.09, 0.004, 0.04);
  EXPECT_THAT(Split(), IsEmpty());
}

TEST_F(SplitAtGapsTest, AHoleOfFiveMillimetresIsNoGap) {
  Block(0, 0.03, 0.004, 0.04);
  Block(0.033, 0.06, 0.004, 0.04);
  EXPECT_THAT(Split(), IsEmpty());
}

TEST_F(SplitAtGapsTest, ASkirtOfTableIsLeftOut) {
  Block(0, 0.03, 0.004, 0.04);
  Block(0.03, 0.10, 0.004, 0.006);
  const auto parts = Split();
  ASSERT_THAT(parts, SizeIs(1));
  EXPECT_LT(parts[0].cloud.points.size(), whole_.cloud.points.size());
}

TEST_F(SplitAtGapsTest, AnEntirelyLowSegmentStaysWhole) {
  Block(0, 0.03, 0.004, 0.006);
  Block(0.05, 0.08, 0.004, 0.006);
  EXPECT_THAT(Split(), IsEmpty());
}

TEST_F(SplitAtGapsTest, WithoutATableEveryGapCounts) {
  seen_.table.reset();
  Block(0, 0.03, 0, 0.006);
  Block(0.045, 0.07, 0, 0.006);
  EXPECT_THAT(Split(), SizeIs(2));
}

}  // namespace
}  // namespace graspdb::recognition
