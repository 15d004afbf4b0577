// Limits of the search for unexplained segments, and the untried views in the answer.
#include "recognition/base/search_budget.h"

#include <gtest/gtest.h>

#include "recognition/recognizer.h"
#include "tests/recognition/scenes/counting_clouds.h"
#include "tests/recognition/scenes/taught_shapes.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::CountingClouds;
using ::graspdb::testing::IsOk;
using ::graspdb::testing::Solid;
using ::graspdb::testing::TaughtShapes;

TEST(SearchBudgetTest, RejectedHypothesesAreCounted) {
  SearchBudget budget(10, std::chrono::hours(1));
  EXPECT_TRUE(budget.Take(8));
  EXPECT_FALSE(budget.Take(3));
  EXPECT_TRUE(budget.Take(2));
  EXPECT_EQ(budget.untried(), 3U);
  EXPECT_FALSE(budget.OutOfTime());
}

TEST(SearchBudgetTest, IsEmptyAfterItsDeadline) {
  SearchBudget budget(10, std::chrono::seconds(-1));
  EXPECT_TRUE(budget.OutOfTime());
  EXPECT_FALSE(budget.Take(1));
  EXPECT_TRUE(budget.out_of_time());
}

class SearchTest : public ::testing::Test {
 protected:
  SearchTest() { parameters_.matching.verified_view_count = 5; }

  Recognition Run(const std::vector<Solid>& parts) {
    const auto found = Recognize(TaughtShapes::See(parts), taught_.snapshot(), taught_, parameters_,
                                 [] { return false; });
    EXPECT_THAT(found, IsOk());
    return found.value_or(Recognition());
  }

  // An unknown object.
  static Solid UnknownSolid() {
    Solid out;
    out.boxes = {{{-0.02, -0.06, 0}, {0.02, 0.06, 0.1}}};
    return out;
  }

  TaughtShapes taught_;
  RecognitionParameters parameters_;
};

TEST_F(SearchTest, AnExplainedSegmentNeedsNoBudget) {
  parameters_.matching.further_view_budget = 0;
  const Recognition found = Run({TaughtShapes::Part("bracket", 0, 0, 7)});
  EXPECT_EQ(found.outcome, RecognitionOutcome::kOk);
  EXPECT_EQ(found.untried_view_count, 0U);
}

TEST_F(SearchTest, UntriedViewsAreCounted) {
  EXPECT_EQ(Run({UnknownSolid()}).untried_view_count, 0U);
  parameters_.matching.further_view_budget = 0;
  const std::size_t all = Run({UnknownSolid()}).untried_view_count;
  parameters_.matching.further_view_budget = 7;
  const Recognition found = Run({UnknownSolid()});
  EXPECT_EQ(found.outcome, RecognitionOutcome::kUnknownObject);
  EXPECT_GT(found.untried_view_count, 0U);
  EXPECT_EQ(found.untried_view_count, all - 7);
  EXPECT_FALSE(found.out_of_time);
  EXPECT_EQ(Run({UnknownSolid()}).untried_view_count, found.untried_view_count);
}

TEST_F(SearchTest, TheAnswerReportsAnExceededDeadline) {
  parameters_.matching.search_ceiling_s = 0;
  const Recognition found = Run({UnknownSolid()});
  EXPECT_EQ(found.outcome, RecognitionOutcome::kUnknownObject);
  EXPECT_TRUE(found.out_of_time);
  EXPECT_GT(found.untried_view_count, 0U);
}

// Making them takes longer than comparing them.
TEST_F(SearchTest, NoModelIsMadeAfterTheDeadline) {
  TaughtShapes models_of_one_view(false);
  CountingClouds clouds(models_of_one_view);
  parameters_.matching.search_ceiling_s = 0;
  const auto found = Recognize(TaughtShapes::See({UnknownSolid()}), models_of_one_view.snapshot(),
                               clouds, parameters_, [] { return false; });
  ASSERT_THAT(found, IsOk());
  EXPECT_TRUE(found->out_of_time);
  EXPECT_GT(found->untried_view_count, 0U);
  // Those of the nearest views only, of the segment and of its rest without low points.
  EXPECT_LE(clouds.count(), 2 * parameters_.matching.verified_view_count);
}

TEST_F(SearchTest, ASegmentTooLargeForOneObjectIsUnknown) {
  parameters_.segmentation.max_object_size_m = 0.05;
  const Recognition found = Run({TaughtShapes::Part("bracket", 0, 0, 7)});
  ASSERT_EQ(found.detections.size(), 1U);
  EXPECT_EQ(found.detections.front().outcome, RecognitionOutcome::kUnknownObject);
  EXPECT_EQ(found.detections.front().rejected_by, Gate::kExtent);
}

}  // namespace
}  // namespace graspdb::recognition
