#include "recognition/points/point_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/recognition/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPoints;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<float> SortedDistances(const Points& points, const Eigen::Vector3f& query) {
  std::vector<float> out;
  for (const auto& p : points) out.push_back((p - query).squaredNorm());
  std::sort(out.begin(), out.end());
  return out;
}

// Every neighbour is another point, at its reported distance.
void ExpectConsistent(const Points& points, const Eigen::Vector3f& query,
                      const std::vector<Neighbor>& found) {
  std::set<int> indices;
  for (const Neighbor& n : found) {
    ASSERT_GE(n.index, 0);
    ASSERT_LT(n.index, static_cast<int>(points.size()));
    const float truth = (points[static_cast<std::size_t>(n.index)] - query).squaredNorm();
    EXPECT_FLOAT_EQ(n.squared_distance, truth);
    EXPECT_TRUE(indices.insert(n.index).second) << "twice: " << n.index;
  }
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
    ExpectConsistent(points_, query, {found});
    EXPECT_FLOAT_EQ(found.squared_distance, SortedDistances(points_, query).front());
  }
}

TEST_P(PointSearchTest, SeveralNearestAgreeWithBruteForce) {
  std::vector<Neighbor> found;
  for (const auto& query : queries_) {
    search_.Nearest(query, 25, &found);
    const std::vector<float> truth = SortedDistances(points_, query);
    ASSERT_THAT(found, SizeIs(std::min<std::size_t>(25, points_.size())));
    ExpectConsistent(points_, query, found);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_FLOAT_EQ(found[i].squared_distance, truth[i]);
    }
  }
}

TEST_P(PointSearchTest, PointsWithinARadiusAgreeWithBruteForce) {
  const float radius = 0.04F;
  std::vector<Neighbor> found;
  for (const auto& query : queries_) {
    search_.Within(query, radius, &found);
    ExpectConsistent(points_, query, found);
    const auto truth = std::ranges::count_if(
        points_, [&](const auto& p) { return (p - query).squaredNorm() <= radius * radius; });
    EXPECT_THAT(found, SizeIs(static_cast<std::size_t>(truth)));
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, PointSearchTest, ::testing::Values(1, 2, 12, 13, 300, 5000));

TEST(PointSearchDuplicatesTest, CoincidentPointsAreAllFound) {
  const Points points(1000, Eigen::Vector3f(0.1F, -0.2F, 0.3F));
  const PointSearch search(points);
  std::vector<Neighbor> found;
  search.Within(points.front(), 1e-4F, &found);
  EXPECT_THAT(found, SizeIs(1000));
  ExpectConsistent(points, points.front(), found);
  search.Nearest(points.front(), 40, &found);
  EXPECT_THAT(found, SizeIs(40));
  ExpectConsistent(points, points.front(), found);
}

TEST(PointSearchEdgeTest, PointAtExactlyTheRadiusIsWithin) {
  const PointSearch search(Points{{0, 0, 0}, {0.5F, 0, 0}, {0, 0.500001F, 0}});
  std::vector<Neighbor> found;
  search.Within({0, 0, 0}, 0.5F, &found);
  EXPECT_THAT(found, SizeIs(2));
}

TEST(PointSearchEdgeTest, NoPointsGiveNoNeighbors) {
  const PointSearch search{Points{}};
  EXPECT_EQ(search.Nearest({0, 0, 0}).index, -1);
  EXPECT_TRUE(std::isinf(search.Nearest({0, 0, 0}).squared_distance));
  std::vector<Neighbor> found(3);
  search.Nearest({0, 0, 0}, 5, &found);
  EXPECT_THAT(found, IsEmpty());
  found.resize(3);
  search.Within({0, 0, 0}, 5, &found);
  EXPECT_THAT(found, IsEmpty());
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
