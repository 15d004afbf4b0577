#include "recognition/points/point_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPoints;

float LeastDistance(const Points& points, const Eigen::Vector3f& query) {
  float out = std::numeric_limits<float>::infinity();
  for (const auto& p : points) out = std::min(out, (p - query).squaredNorm());
  return out;
}

class PointSearchTest : public ::testing::TestWithParam<std::size_t> {
 protected:
  PointSearchTest() : points_(RandomPoints(random_, GetParam(), 0.2)), search_(points_) {
    queries_ = RandomPoints(random_, 50, 0.3);
    queries_.insert(queries_.end(), points_.begin(),
                    points_.begin() + static_cast<int>(std::min<std::size_t>(20, GetParam())));
  }

  Random random_{7};
  Points points_;
  PointSearch search_;
  Points queries_;
};

TEST_P(PointSearchTest, NearestAgreesWithBruteForce) {
  for (const auto& query : queries_) {
    const Neighbor found = search_.Nearest(query);
    ASSERT_GE(found.index, 0);
    ASSERT_LT(found.index, static_cast<int>(points_.size()));
    EXPECT_FLOAT_EQ((points_[static_cast<std::size_t>(found.index)] - query).squaredNorm(),
                    LeastDistance(points_, query));
    EXPECT_FLOAT_EQ(found.squared_distance, LeastDistance(points_, query));
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, PointSearchTest, ::testing::Values(1, 2, 12, 13, 300, 5000));

TEST(PointSearchEdgeTest, NoPointsGiveNoNeighbors) {
  const PointSearch search{Points{}};
  EXPECT_EQ(search.Nearest({0, 0, 0}).index, -1);
  EXPECT_TRUE(std::isinf(search.Nearest({0, 0, 0}).squared_distance));
}

TEST(PointSearchEdgeTest, SearchOutlivesThePointsItWasMadeFrom) {
  Points points = {{1, 0, 0}, {0, 2, 0}};
  const PointSearch search(points);
  points.assign(2, Eigen::Vector3f::Zero());
  EXPECT_EQ(search.Nearest({0, 1.9F, 0}).index, 1);
}

TEST(PointSearchEdgeTest, SearchStillWorksAfterItWasMoved) {
  PointSearch first(Points{{1, 0, 0}, {0, 2, 0}});
  const PointSearch second(std::move(first));
  EXPECT_EQ(second.Nearest({0, 1.9F, 0}).index, 1);
}

}  // namespace
}  // namespace graspdb::recognition
