#include "recognition/segmentation/clusters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb::recognition {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Points Line(std::initializer_list<float> heights) {
  Points out;
  for (const float z : heights) out.emplace_back(0.0F, 0.0F, z);
  return out;
}

std::vector<double> Heights(const Points& points) {
  std::vector<double> out;
  for (const auto& p : points) out.push_back(p.z());
  return out;
}

TEST(FindClustersTest, PointsInReachOfEachOtherAreOneCluster) {
  const Points points = Line({0, 9, 1, 10, 2, 20});
  EXPECT_THAT(FindClusters(points, 1.5, 1),
              ElementsAre(ElementsAre(0, 2, 4), ElementsAre(1, 3), ElementsAre(5)));
}

TEST(FindClustersTest, SmallClustersAreLeftOut) {
  const Points points = Line({0, 9, 1, 10, 2, 20});
  EXPECT_THAT(FindClusters(points, 1.5, 3), ElementsAre(ElementsAre(0, 2, 4)));
  EXPECT_THAT(FindClusters(points, 1.5, 4), IsEmpty());
}

TEST(FindClustersTest, PointsAtExactlyTheToleranceAreOneCluster) {
  const Points points = Line({0, 1, 2});
  EXPECT_THAT(FindClusters(points, 1, 1), ElementsAre(ElementsAre(0, 1, 2)));
}

TEST(FindClustersTest, NoPointsGiveNoClusters) { EXPECT_THAT(FindClusters({}, 1, 1), IsEmpty()); }

class JoinUnsupportedTest : public ::testing::Test {
 protected:
  static std::vector<Indices> Join(const Points& points, std::vector<Indices> clusters,
                                   double gap) {
    return JoinUnsupported(points, Heights(points), std::move(clusters), gap);
  }
};

TEST_F(JoinUnsupportedTest, ClusterInTheAirJoinsTheNearestBelow) {
  const Points points = Line({0, 1, 4, 5});
  EXPECT_THAT(Join(points, {{0, 1}, {2, 3}}, 3.5), ElementsAre(ElementsAre(0, 1, 2, 3)));
}

TEST_F(JoinUnsupportedTest, OrderOfTheClustersDoesNotMatter) {
  const Points points = Line({4, 5, 0, 1});
  EXPECT_THAT(Join(points, {{0, 1}, {2, 3}}, 3.5), ElementsAre(ElementsAre(0, 1, 2, 3)));
}

TEST_F(JoinUnsupportedTest, ClusterFarFromEveryOtherStaysAlone) {
  const Points points = Line({0, 1, 9, 10});
  EXPECT_THAT(Join(points, {{0, 1}, {2, 3}}, 3.5),
              ElementsAre(ElementsAre(0, 1), ElementsAre(2, 3)));
}

TEST_F(JoinUnsupportedTest, ClustersThatBothStandOnTheTableStayApart) {
  const Points points = {{0, 0, 0}, {0, 0, 1}, {2, 0, 0}, {2, 0, 1}};
  EXPECT_THAT(Join(points, {{0, 1}, {2, 3}}, 2.5),
              ElementsAre(ElementsAre(0, 1), ElementsAre(2, 3)));
}

TEST_F(JoinUnsupportedTest, TheNearerOfTwoSupportsIsTaken) {
  const Points points = {{-3, 0, 0}, {-3, 0, 3}, {2, 0, 0}, {2, 0, 3}, {0, 0, 4}};
  EXPECT_THAT(Join(points, {{0, 1}, {2, 3}, {4}}, 3.5),
              ElementsAre(ElementsAre(0, 1), ElementsAre(2, 3, 4)));
}

TEST_F(JoinUnsupportedTest, PartsStackedInTheAirAllJoin) {
  const Points points = Line({1, 3.9F, 7, 10});
  EXPECT_THAT(Join(points, {{3}, {2}, {1}, {0}}, 3.2), ElementsAre(ElementsAre(0, 1, 2, 3)));
  EXPECT_THAT(Join(points, {{0}, {1}, {2}, {3}}, 3.2), ElementsAre(ElementsAre(0, 1, 2, 3)));
}

TEST_F(JoinUnsupportedTest, PointsOfNoClusterSupportNothing) {
  const Points points = Line({3, 5, 6});
  EXPECT_THAT(Join(points, {{1, 2}}, 4.5), ElementsAre(ElementsAre(1, 2)));
}

TEST_F(JoinUnsupportedTest, NoClustersStayNone) { EXPECT_THAT(Join(Line({0}), {}, 1), IsEmpty()); }

}  // namespace
}  // namespace graspdb::recognition
