#include "recognition/base/top_scores.h"

#include <gtest/gtest.h>

#include <random>

namespace graspdb::recognition {
namespace {

TEST(TopScores, AnyScoreIsAmongTheFirst) {
  TopScores top(2, 0.5);
  EXPECT_EQ(top.min(), 0);
  top.Add(0);
  EXPECT_EQ(top.min(), 0);
}

TEST(TopScores, AShareOfTheLargestIsRequired) {
  TopScores top(10, 0.5);
  top.Add(0.8);
  top.Add(0.1);
  EXPECT_EQ(top.min(), 0.4);
}

TEST(TopScores, TheSmallestOfTheLargestIsRequired) {
  constexpr std::size_t kCount = 24;
  TopScores top(kCount, 0.01);
  std::mt19937 random_numbers(1);
  std::vector<double> all;
  for (int i = 0; i < 300; ++i) {
    all.push_back(std::uniform_real_distribution(0.1, 1.0)(random_numbers));
    const double before = top.min();
    top.Add(all.back());
    EXPECT_GE(top.min(), before);
  }
  std::ranges::sort(all, std::greater());
  EXPECT_EQ(top.min(), all[kCount - 1]);
}

}  // namespace
}  // namespace graspdb::recognition
