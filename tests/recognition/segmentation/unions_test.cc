#include "recognition/segmentation/unions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb::recognition {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

// A cube of 20 mm, its corners only, whose lowest corner is at x.
Segment CubeAt(float x) {
  Segment out;
  for (const float dx : {0.0F, 0.02F}) {
    for (const float y : {0.0F, 0.02F}) {
      for (const float z : {0.0F, 0.02F}) {
        out.indices.push_back(static_cast<std::int32_t>(out.indices.size()));
        out.cloud.points.emplace_back(x + dx, y, z);
        out.cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
      }
    }
  }
  out.centroid = Centroid(out.cloud.points);
  return out;
}

std::vector<SegmentPair> PairsOf(const std::vector<Segment>& segments, double max_size_m) {
  std::vector<const Segment*> pointers;
  pointers.reserve(segments.size());
  for (const Segment& segment : segments) pointers.push_back(&segment);
  return NeighbouringPairs(pointers, 0.03, max_size_m);
}

TEST(NeighbouringPairs, AreThoseWithASmallGapTheSmallestFirst) {
  // Gaps of 25, 10 and 100 mm.
  const std::vector<Segment> row = {CubeAt(0), CubeAt(0.045F), CubeAt(0.075F), CubeAt(0.195F)};
  EXPECT_THAT(PairsOf(row, 1), ElementsAre(Pair(1, 2), Pair(0, 1)));
}

TEST(NeighbouringPairs, TogetherAreNoLargerThanAnObject) {
  EXPECT_THAT(PairsOf({CubeAt(0), CubeAt(0.03F)}, 0.04), IsEmpty());
}

TEST(UnionOf, HasThePointsOfBoth) {
  const Segment both = UnionOf(CubeAt(0), CubeAt(0.04F));
  EXPECT_EQ(both.indices.size(), 16);
  EXPECT_EQ(both.cloud.points.size(), 16);
  EXPECT_EQ(both.cloud.normals.size(), 16);
  EXPECT_TRUE(both.centroid.isApprox(Eigen::Vector3d(0.03, 0.01, 0.01), 1e-6));
}

}  // namespace
}  // namespace graspdb::recognition
