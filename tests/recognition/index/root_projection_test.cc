#include "recognition/index/root_projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::Uniform;

using Rows = std::vector<std::vector<float>>;

constexpr std::size_t kRowBins = 60;

// Sums of a few patterns, and a little of every bin.
Rows Sample(Random& random, std::size_t count) {
  Rows out;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<float> row(kRowBins);
    const double phase = Uniform(random, 0, 6);
    const double waves = Uniform(random, 1, 3);
    for (std::size_t j = 0; j < kRowBins; ++j) {
      const double wave = 1 + std::sin(phase + waves * static_cast<double>(j) / 10);
      row[j] = static_cast<float>(0.1 * wave + Uniform(random, 0, 0.01));
    }
    out.push_back(row);
  }
  return out;
}

double Distance(const std::vector<float>& a, const std::vector<float>& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    squares += std::pow(static_cast<double>(a[i]) - b[i], 2);
  }
  return std::sqrt(squares);
}

TEST(RootProjectionTest, DistancesBecomeNoLarger) {
  Random random(5);
  const Rows rows = Sample(random, 500);
  const auto projection = RootProjection::Fit(rows);
  ASSERT_NE(projection, nullptr);
  double kept = 0;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const auto a = projection->Project(rows[i]);
    const auto b = projection->Project(rows[i + 1]);
    const double projected = Distance(a.components, b.components);
    const double whole = Distance(rows[i], rows[i + 1]);
    EXPECT_LE(projected, whole + a.rounding + b.rounding);
    EXPECT_LE(a.rounding, 1e-4);
    kept += projected / whole;
  }
  EXPECT_GE(kept / static_cast<double>(rows.size() - 1), 0.9);
}

TEST(RootProjectionTest, DistancesOfOtherHistogramsBecomeNoLargerEither) {
  Random random(6);
  const auto projection = RootProjection::Fit(Sample(random, 500));
  ASSERT_NE(projection, nullptr);
  for (const double size : {1e-20, 1e-6, 1.0, 1e6}) {
    std::vector<float> a(kRowBins);
    std::vector<float> b(kRowBins);
    for (float& x : a) x = static_cast<float>(Uniform(random, 0, size));
    for (float& x : b) x = static_cast<float>(Uniform(random, 0, size));
    const auto pa = projection->Project(a);
    const auto pb = projection->Project(b);
    EXPECT_LE(Distance(pa.components, pb.components), Distance(a, b) + pa.rounding + pb.rounding);
  }
}

TEST(RootProjectionTest, IsNullWhereItWouldKeepLittleVariance) {
  Random random(7);
  Rows independent(2000, std::vector<float>(288));
  for (auto& row : independent) {
    for (float& x : row) x = static_cast<float>(Uniform(random, 0, 1));
  }
  EXPECT_EQ(RootProjection::Fit(independent), nullptr);
}

TEST(RootProjectionTest, IsNullForTooFewRowsAndForNonFiniteValues) {
  Random random(8);
  Rows rows = Sample(random, 100);
  EXPECT_NE(RootProjection::Fit(rows), nullptr);
  rows[50][7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(RootProjection::Fit(rows), nullptr);
  rows[50][7] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(RootProjection::Fit(rows), nullptr);
  EXPECT_EQ(RootProjection::Fit({}), nullptr);
  EXPECT_EQ(RootProjection::Fit(Sample(random, 31)), nullptr);
  EXPECT_EQ(RootProjection::Fit(Rows(100, std::vector<float>(31, 0.1F))), nullptr);
}

}  // namespace
}  // namespace graspdb::recognition
