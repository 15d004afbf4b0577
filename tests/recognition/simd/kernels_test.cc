// The SIMD kernels against plain loops, and against each other bit by bit.
#include "recognition/simd/kernels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition::simd {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::Uniform;
using ::testing::ElementsAreArray;
using ::testing::FloatEq;
using ::testing::FloatNear;
using ::testing::Pointwise;

constexpr std::size_t kCount = 240;

std::vector<float> Numbers(Random& random, std::size_t count, double low, double high) {
  std::vector<float> out;
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(static_cast<float>(Uniform(random, low, high)));
  }
  return out;
}

// Points in a cube, the last ones padding.
struct Cloud {
  explicit Cloud(Random& random)
      : x(Numbers(random, kCount, -1, 1)),
        y(Numbers(random, kCount, -1, 1)),
        z(Numbers(random, kCount, -1, 1)) {
    x.back() = y.back() = z.back() = kFar;
  }
  Coordinates coordinates() const { return {x.data(), y.data(), z.data(), kCount}; }
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;
};

class KernelsTest : public ::testing::TestWithParam<const Functions*> {
 protected:
  const Functions& kernels_ = *GetParam();
  Random random_{11};
};

TEST_P(KernelsTest, DistancesCountsAndRootsEqualAPlainLoop) {
  const Cloud cloud(random_);
  const float query[3] = {0.1F, -0.2F, 0.3F};
  std::vector<float> squared(kCount);
  kernels_.squared_distances(cloud.coordinates(), query, squared.data());
  std::size_t count = 0;
  double roots = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double dx = static_cast<double>(cloud.x[i] - query[0]);
    const double dy = static_cast<double>(cloud.y[i] - query[1]);
    const double dz = static_cast<double>(cloud.z[i] - query[2]);
    EXPECT_THAT(squared[i], FloatEq(static_cast<float>(dx * dx + dy * dy + dz * dz)));
    if (squared[i] > 0.5F) continue;
    ++count;
    roots += std::sqrt(static_cast<double>(squared[i]));
  }
  ASSERT_GT(count, 0U);
  EXPECT_EQ(kernels_.count_up_to(squared.data(), kCount, 0.5F), count);
  EXPECT_THAT(kernels_.sum_roots_up_to(squared.data(), kCount, 0.5F),
              FloatNear(static_cast<float>(roots), 1e-4F));
}

TEST_P(KernelsTest, MomentsCoverThePointsWithinTheRadius) {
  const Cloud cloud(random_);
  const float query[3] = {0, 0.1F, 0};
  const Moments found = kernels_.moments(cloud.coordinates(), query, 0.25F);
  double count = 0;
  double x = 0;
  double yz = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double dx = static_cast<double>(cloud.x[i]);
    const double dy = static_cast<double>(cloud.y[i] - query[1]);
    const double dz = static_cast<double>(cloud.z[i]);
    if (dx * dx + dy * dy + dz * dz > 0.25) continue;
    count += 1;
    x += dx;
    yz += dy * dz;
  }
  EXPECT_EQ(found.count, static_cast<float>(count));
  EXPECT_THAT(found.first[0], FloatNear(static_cast<float>(x), 1e-4F));
  EXPECT_THAT(found.second[4], FloatNear(static_cast<float>(yz), 1e-4F));
}

TEST_P(KernelsTest, PointsNearAPlaneAreCountedOnBothSides) {
  std::vector<float> z(kCount, 0);
  z[0] = 0.9F;
  z[1] = 1.1F;
  z[2] = 0.7F;
  z[3] = 1.3F;
  z[4] = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> zero(kCount, 0);
  const float up[3] = {0, 0, 1};
  EXPECT_EQ(kernels_.count_near_plane({zero.data(), zero.data(), z.data(), kCount}, up, 1, 0.2F),
            2U);
}

TEST_P(KernelsTest, BytesAreFarthestApartWhereTheyDifferMost) {
  const std::vector<std::uint8_t> rows = [] {
    std::vector<std::uint8_t> out(64, 0);
    std::fill_n(out.begin(), 32, 255);
    out[32] = 3;
    return out;
  }();
  const std::vector<std::uint8_t> query(32, 0);
  std::vector<std::int32_t> found(2);
  kernels_.byte_distances(rows.data(), 32, 2, query.data(), found.data());
  EXPECT_THAT(found, ElementsAreArray({32 * 255 * 255, 9}));
}

TEST_P(KernelsTest, ChiSquareLeavesOutBinsEmptyInBoth) {
  std::vector<float> a(16, 0);
  std::vector<float> b(16, 0);
  a[1] = 0.5F;
  b[9] = 0.5F;
  a[3] = b[3] = 0.25F;
  EXPECT_FLOAT_EQ(kernels_.chi_square(a.data(), b.data(), 16), 1);
}

TEST_P(KernelsTest, PixelsAreInsideUpToTheFacesOfTheRegion) {
  const std::vector<std::uint16_t> counts = {0, 1000, 1000, 1000, 2000};
  const std::vector<float> column = {0, -0.5F, 0, 0.5F, 0};
  DepthRow row;
  row.counts = counts.data();
  row.column = column.data();
  row.world_sensor.rotation[0][0] = row.world_sensor.rotation[1][1] =
      row.world_sensor.rotation[2][2] = 1;
  row.unit = 0.001F;
  row.farthest = 100;
  row.min[0] = -0.5F;
  row.min[1] = -1;
  row.max[0] = 0.25F;
  row.max[1] = 1;
  row.max[2] = 1;
  row.width = 5;
  std::vector<float> x(5);
  std::vector<float> y(5);
  std::vector<float> z(5);
  std::vector<std::uint8_t> inside(5);
  kernels_.unproject(row, x.data(), y.data(), z.data(), inside.data());
  EXPECT_THAT(inside, ElementsAreArray({0, 1, 1, 0, 0}));
  EXPECT_FLOAT_EQ(x[1], -0.5F);
  EXPECT_FLOAT_EQ(z[1], 1);
}

// Cells of 1 m around two points in a row of three blocks, of which the last one is first in
// memory.
std::vector<std::int32_t> Spread(const Functions& kernels) {
  const std::int32_t begins[3] = {kBlockCells, 2 * kBlockCells, 0};
  std::vector<float> best(std::size_t{3} * kBlockCells, 9);
  std::vector<std::int32_t> nearest(std::size_t{3} * kBlockCells, -1);
  const Cells cells = {{begins, 3, 3}, 1, best.data(), nearest.data()};
  const BallRow row = {0, 0, 4};
  for (const int i : {0, 1}) {
    const float at[3] = {i == 0 ? 7.5F : 12.4F, 0.5F, 0.5F};
    kernels.spread(&row, 1, at, i, cells);
  }
  std::vector<std::int32_t> out;
  for (int x = 3; x < 17; ++x) {
    const int at[3] = {x, 0, 0};
    out.push_back(nearest[static_cast<std::size_t>(begins[BlockOf(cells.blocks, at)]) +
                          static_cast<std::size_t>(CellInBlock(at))]);
  }
  return out;
}

TEST_P(KernelsTest, CellsStoreTheNearestPointWithinReach) {
  EXPECT_THAT(Spread(kernels_), ElementsAreArray({-1, -1, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, -1, -1}));
}

TEST_P(KernelsTest, BitsEqualThePortableFunctions) {
  const Functions& portable = Portable();
  const float query[3] = {0.05F, -0.3F, 0.2F};
  for (int round = 0; round < 50; ++round) {
    const Cloud cloud(random_);
    std::vector<float> ours(kCount);
    std::vector<float> theirs(kCount);
    kernels_.squared_distances(cloud.coordinates(), query, ours.data());
    portable.squared_distances(cloud.coordinates(), query, theirs.data());
    ASSERT_THAT(ours, Pointwise(::testing::Eq(), theirs));
    ASSERT_EQ(kernels_.sum_roots_up_to(ours.data(), kCount, 0.7F),
              portable.sum_roots_up_to(ours.data(), kCount, 0.7F));
    const Moments a = kernels_.moments(cloud.coordinates(), query, 0.6F);
    const Moments b = portable.moments(cloud.coordinates(), query, 0.6F);
    ASSERT_THAT(a.second, ElementsAreArray(b.second));
    ASSERT_THAT(a.first, ElementsAreArray(b.first));
    ASSERT_EQ(Spread(kernels_), Spread(portable));
    const auto p = Numbers(random_, kCount, 0, 1);
    const auto q = Numbers(random_, kCount, 0, 1);
    ASSERT_EQ(kernels_.chi_square(p.data(), q.data(), kCount),
              portable.chi_square(p.data(), q.data(), kCount));
  }
}

INSTANTIATE_TEST_SUITE_P(Functions, KernelsTest, ::testing::Values(&Portable(), &Best()),
                         [](const auto& test) {
                           return test.index == 0 ? std::string("Portable") : std::string("Best");
                         });

}  // namespace
}  // namespace graspdb::recognition::simd
