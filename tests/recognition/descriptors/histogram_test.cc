#include "recognition/descriptors/histogram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace graspdb::recognition {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatNear;

// Four bins over [-1, 1], each 0.5 wide; the shared strip is 0.005 to each side of an edge.
std::vector<float> Bins(std::initializer_list<double> values, double mass) {
  Histogram histogram(-1, 1, 4);
  for (const double value : values) histogram.Add(value);
  std::vector<float> out(histogram.size());
  histogram.Write(mass, out);
  return out;
}

TEST(HistogramTest, ValueInTheMiddleOfABinCountsThereAlone) {
  EXPECT_THAT(Bins({-0.75}, 1), ElementsAre(1, 0, 0, 0));
  EXPECT_THAT(Bins({-0.25}, 1), ElementsAre(0, 1, 0, 0));
  EXPECT_THAT(Bins({0.25}, 1), ElementsAre(0, 0, 1, 0));
  EXPECT_THAT(Bins({0.75}, 1), ElementsAre(0, 0, 0, 1));
}

TEST(HistogramTest, EndsOfTheIntervalBelongToTheEndBins) {
  EXPECT_THAT(Bins({-1}, 1), ElementsAre(1, 0, 0, 0));
  EXPECT_THAT(Bins({1}, 1), ElementsAre(0, 0, 0, 1));
}

TEST(HistogramTest, ValuesOutsideGoToTheEndBins) {
  EXPECT_THAT(Bins({-1.0001, -7}, 1), ElementsAre(1, 0, 0, 0));
  EXPECT_THAT(Bins({1.0001, 7}, 1), ElementsAre(0, 0, 0, 1));
}

TEST(HistogramTest, ValueOnAnEdgeIsSharedEvenly) {
  EXPECT_THAT(Bins({0}, 1), ElementsAre(0, 0.5, 0.5, 0));
}

TEST(HistogramTest, ShareFallsWithTheDistanceFromTheEdge) {
  const float tolerance = 1e-6F;
  const std::vector<float> above = Bins({0.0025}, 1);  // half of the shared strip
  EXPECT_NEAR(above[1], 0.25F, tolerance);
  EXPECT_NEAR(above[2], 0.75F, tolerance);
  const std::vector<float> below = Bins({-0.0025}, 1);
  EXPECT_NEAR(below[1], 0.75F, tolerance);
  EXPECT_NEAR(below[2], 0.25F, tolerance);
  EXPECT_THAT(Bins({0.0051}, 1), ElementsAre(0, 0, 1, 0));
}

TEST(HistogramTest, LastDigitOfACoordinateMovesAThousandthOfACount) {
  const double rounding = 1e-6;
  for (const double value : {-0.5, 0.0, 0.004999, 0.005001, 0.5, 0.999999}) {
    const std::vector<float> at = Bins({value}, 1);
    const std::vector<float> beside = Bins({value + rounding}, 1);
    for (std::size_t i = 0; i < at.size(); ++i) EXPECT_NEAR(at[i], beside[i], 1e-3) << value;
  }
}

TEST(HistogramTest, CountsAreScaledToTheMass) {
  EXPECT_THAT(Bins({-0.75, -0.75, -0.75, 0.25}, 100), ElementsAre(75, 0, 25, 0));
  const std::vector<float> spread = Bins({-2, -0.5, 0.001, 0.3, 0.4999, 2}, 0.25);
  EXPECT_NEAR(std::accumulate(spread.begin(), spread.end(), 0.0), 0.25, 1e-6);
}

TEST(HistogramTest, EmptyHistogramIsAllZero) { EXPECT_THAT(Bins({}, 1), Each(FloatNear(0, 0))); }

}  // namespace
}  // namespace graspdb::recognition
