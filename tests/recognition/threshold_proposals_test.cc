// Thresholds from the scores of right and wrong answers for taught views.
#include "recognition/threshold_proposals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "tests/recognition/scenes/taught_shapes.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::graspdb::testing::TaughtShapes;
using ::testing::ElementsAre;
using ::testing::Pair;
using ::testing::SizeIs;

constexpr double kUsual = 0.5;

TEST(ThresholdBetween, IsTheUsualOneForHighRightScores) {
  EXPECT_EQ(ThresholdBetween(1.0, 0.0, kUsual), kUsual);
  EXPECT_EQ(ThresholdBetween(1.0, {}, kUsual), kUsual);
}

TEST(ThresholdBetween, LiesHalfWayForLowRightScores) {
  EXPECT_DOUBLE_EQ(ThresholdBetween(0.6, 0.1, kUsual), 0.35);
  EXPECT_DOUBLE_EQ(ThresholdBetween(0.6, {}, kUsual), 0.3);
}

TEST(ThresholdBetween, IsTheUsualOneWhereRightAndWrongScoresOverlap) {
  EXPECT_EQ(ThresholdBetween(0.3, 0.4, kUsual), kUsual);
  EXPECT_EQ(ThresholdBetween({}, 0.1, kUsual), kUsual);
}

TEST(ThresholdBetween, IsNeverTooLowNorAboveTheUsualOne) {
  EXPECT_EQ(ThresholdBetween(0.02, 0.0, kUsual), 0.1);
  EXPECT_EQ(ThresholdBetween(0.98, 0.9, kUsual), kUsual);
  EXPECT_EQ(ThresholdBetween(0.02, 0.0, 0.05), 0.05);
}

class ProposeThresholdsTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::vector<ThresholdProposal>> Propose(const std::string& object) {
    return ProposeThresholds(
        taught_.snapshot(), taught_, object, {}, [] { return false; },
        [this](std::size_t done, std::size_t count) {
          reports_.emplace_back(done, count);
          return reports_.size() == stop_at_ ? absl::AbortedError("enough") : absl::OkStatus();
        });
  }

  TaughtShapes taught_;
  std::vector<std::pair<std::size_t, std::size_t>> reports_;
  std::size_t stop_at_ = 1000;
};

TEST_F(ProposeThresholdsTest, DifferentObjectsNeedNoThresholdOfTheirOwn) {
  const auto all = Propose("");
  ASSERT_THAT(all, IsOk());
  ASSERT_THAT(*all, SizeIs(3));
  for (const ThresholdProposal& p : *all) {
    EXPECT_EQ(p.right_views, p.query_views) << p.stable_pose;
    EXPECT_EQ(p.query_views, 8) << p.stable_pose;
    EXPECT_GT(p.right_score.value_or(0), 0.8) << p.stable_pose;
    // A slab cut out of a scan may resemble half a bracket.
    EXPECT_LT(p.wrong_score.value_or(0), p.right_score.value_or(0) - 0.1) << p.stable_pose;
    EXPECT_EQ(p.min_score, std::nullopt) << p.stable_pose;
  }
  const auto of_one = Propose("objects/tower");
  ASSERT_THAT(of_one, IsOk());
  ASSERT_THAT(*of_one, SizeIs(1));
  const ThresholdProposal& its = of_one->front();
  EXPECT_TRUE(its.stable_pose.starts_with("objects/tower/"));
  const auto same = std::ranges::find(*all, its.stable_pose, &ThresholdProposal::stable_pose);
  EXPECT_EQ(its.right_score, same->right_score);
  EXPECT_EQ(its.wrong_score, same->wrong_score);
  EXPECT_EQ(its.min_score, same->min_score);
}

TEST_F(ProposeThresholdsTest, ProgressIsReportedBeforeEachViewAndMayEndTheWork) {
  stop_at_ = 2;
  EXPECT_THAT(Propose(""), StatusIs(absl::StatusCode::kAborted));
  EXPECT_THAT(reports_, ElementsAre(Pair(0, 24), Pair(1, 24)));
}

}  // namespace
}  // namespace graspdb::recognition
