// The histogram of a load test.
#include "program/base/latency_histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace graspdb {
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

// The percentile of the nearest rank, from all values.
double Exact(std::vector<std::int64_t> values, double percent) {
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(percent / 100 * static_cast<double>(values.size()) - 1e-9);
  return static_cast<double>(values[static_cast<std::size_t>(std::max(1.0, rank)) - 1]);
}

TEST(LatencyHistogram, PercentilesOfKnownData) {
  LatencyHistogram histogram;
  for (int i = 1; i <= 1000; ++i) histogram.Record(microseconds(i));
  EXPECT_EQ(histogram.count(), 1000);
  EXPECT_EQ(histogram.Min(), microseconds(1));
  EXPECT_EQ(histogram.Max(), microseconds(1000));
  EXPECT_EQ(histogram.Mean(), nanoseconds(500'500));
  const auto us = [&](double percent) {
    return static_cast<double>(histogram.Percentile(percent).count()) / 1000;
  };
  EXPECT_EQ(us(0), 1);
  EXPECT_NEAR(us(50), 500, 0.5);
  EXPECT_NEAR(us(90), 900, 0.9);
  EXPECT_NEAR(us(99), 990, 1);
  EXPECT_NEAR(us(99.9), 999, 1);  // not the thousandth
  EXPECT_LT(us(99.9), 1000);
  EXPECT_EQ(us(100), 1000);
}

TEST(LatencyHistogram, ThreeDigitsAreRightFromAMicrosecondToAnHour) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(3, 12.55);  // 10^n ns
  LatencyHistogram histogram;
  std::vector<std::int64_t> values;
  for (int i = 0; i < 20'000; ++i) {
    values.push_back(static_cast<std::int64_t>(std::pow(10, exponent(random))));
    histogram.Record(nanoseconds(values.back()));
  }
  for (const double percent : {0.1, 1.0, 10.0, 25.0, 50.0, 75.0, 90.0, 99.0, 99.9, 99.99}) {
    const double exact = Exact(values, percent);
    const auto estimate = static_cast<double>(histogram.Percentile(percent).count());
    EXPECT_GE(estimate, exact) << percent;
    EXPECT_LE(estimate, exact * 1.001) << percent;
  }
}

TEST(LatencyHistogram, MergedPartsEqualTheWhole) {
  LatencyHistogram whole;
  LatencyHistogram odd;
  LatencyHistogram even;
  for (int i = 1; i <= 999; ++i) {
    const nanoseconds time = microseconds(i * i);
    whole.Record(time);
    (i % 2 == 0 ? even : odd).Record(time);
  }
  LatencyHistogram merged;
  merged.Merge(even);
  merged.Merge(LatencyHistogram());
  merged.Merge(odd);
  EXPECT_EQ(merged.count(), whole.count());
  EXPECT_EQ(merged.Min(), whole.Min());
  EXPECT_EQ(merged.Max(), whole.Max());
  EXPECT_EQ(merged.Sum(), whole.Sum());
  for (double percent = 0; percent <= 100; percent += 0.5) {
    EXPECT_EQ(merged.Percentile(percent), whole.Percentile(percent)) << percent;
  }
}

TEST(LatencyHistogram, ExtremeValuesAreRecorded) {
  LatencyHistogram histogram;
  histogram.Record(nanoseconds(0));
  histogram.Record(nanoseconds(-5));
  histogram.Record(nanoseconds(1));
  const nanoseconds longest(std::numeric_limits<std::int64_t>::max() / 2);
  histogram.Record(longest);
  EXPECT_EQ(histogram.Min(), nanoseconds(0));
  EXPECT_EQ(histogram.Max(), longest);
  EXPECT_EQ(histogram.Percentile(50), nanoseconds(0));
  EXPECT_EQ(histogram.Percentile(75), nanoseconds(1));
  EXPECT_EQ(histogram.Percentile(100), longest);
}

TEST(LatencyHistogram, OneValueIsEveryPercentile) {
  LatencyHistogram histogram;
  const nanoseconds time = hours(1) + nanoseconds(7);
  histogram.Record(time);
  for (const double percent : {0.0, 50.0, 99.9, 100.0}) {
    EXPECT_EQ(histogram.Percentile(percent), time);
  }
}

TEST(LatencyHistogram, EmptyHistogramIsZero) {
  const LatencyHistogram histogram;
  EXPECT_EQ(histogram.count(), 0);
  EXPECT_EQ(histogram.Mean(), nanoseconds(0));
  EXPECT_EQ(histogram.Percentile(99), nanoseconds(0));
  EXPECT_EQ(histogram.CountBelow(hours(1)), 0);
}

TEST(LatencyHistogram, CountsValuesBelow) {
  LatencyHistogram histogram;
  for (int i = 1; i <= 10; ++i) histogram.Record(milliseconds(i));
  EXPECT_EQ(histogram.CountBelow(milliseconds(0)), 0);
  EXPECT_EQ(histogram.CountBelow(microseconds(4500)), 4);
  EXPECT_EQ(histogram.CountBelow(milliseconds(11)), 10);
}

}  // namespace
}  // namespace graspdb
