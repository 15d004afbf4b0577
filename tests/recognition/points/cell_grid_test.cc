#include "recognition/points/cell_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "recognition/segmentation/clusters.h"
#include "recognition/segmentation/outliers.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPoints;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAreArray;

TEST(CellGridTest, EveryPointIsInOneCell) {
  Random random(1);
  const Points points = RandomPoints(random, 500, 0.2);
  const CellGrid grid(points, 0.03F);
  Indices all(points.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_THAT(grid.order(), UnorderedElementsAreArray(all));
  std::int32_t end = 0;
  for (const CellGrid::Cell& cell : grid.OccupiedCells()) {
    EXPECT_EQ(cell.begin, end);
    end = cell.end;
    for (std::int32_t i = cell.begin; i < cell.end; ++i) {
      const auto point = static_cast<std::size_t>(grid.order()[static_cast<std::size_t>(i)]);
      EXPECT_EQ(grid.CellOf(points[point]), cell.at);
    }
  }
  EXPECT_EQ(end, 500);
}

TEST(CellGridTest, ABlockHasAllPointsWithinItsCoverage) {
  Random random(2);
  const Points points = RandomPoints(random, 2000, 0.2);
  const CellGrid grid(points, 0.02F);
  CellBlock block;
  for (std::size_t query = 0; query < points.size(); query += 97) {
    grid.Gather(grid.CellOf(points[query]), 1, &block);
    const float coverage = std::min(block.Coverage(points[query]), 1.0F);
    ASSERT_GT(coverage, 0.019F);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if ((points[i] - points[query]).norm() > coverage) continue;
      bool found = false;
      for (std::size_t j = 0; j < block.x.size(); ++j) {
        found = found || points[i] == Eigen::Vector3f(block.x[j], block.y[j], block.z[j]);
      }
      EXPECT_TRUE(found);
    }
  }
}

TEST(CellGridTest, NoPointsGiveNoCells) {
  EXPECT_THAT(CellGrid({}, 0.01F).OccupiedCells(), IsEmpty());
}

TEST(CellGridTest, FarPointsNeitherGrowTheCellsNorTheMemory) {
  const Points points = {{0, 0, 0}, {100, 100, 100}, {0, 0, 0.0015F}};
  const CellGrid grid(points, 0.001F);
  EXPECT_EQ(grid.cell_m(), 0.001F);
  EXPECT_THAT(grid.OccupiedCells(), SizeIs(3));
}

TEST(CellGridTest, AListOfCellsFindsTheSameAsATable) {
  Random random(4);
  const Points points = RandomPoints(random, 3000, 0.2);
  Points with_far = points;
  with_far.emplace_back(90, 90, 90);
  const CellGrid table(points, 0.02F);
  const CellGrid list(with_far, 0.02F);
  ASSERT_EQ(table.OccupiedCells().size() + 1, list.OccupiedCells().size());
  for (const Eigen::Vector3f& p : points) {
    Indices of_table;
    Indices of_list;
    table.ForEachPoint(p, 2, [&](std::size_t i) { of_table.push_back(static_cast<int>(i)); });
    list.ForEachPoint(p, 2, [&](std::size_t i) { of_list.push_back(static_cast<int>(i)); });
    ASSERT_EQ(of_list, of_table);
  }
}

TEST(CellGridTest, ACancelledGridHasNoPoints) {
  for (const float cell_m : {0.02F, 1e-4F}) {
    const CellGrid grid({{0, 0, 0}, {0.1F, 0.1F, 0.1F}}, cell_m, [] { return true; });
    EXPECT_THAT(grid.OccupiedCells(), IsEmpty());
    EXPECT_EQ(grid.CountAround(grid.CellOf({0.1F, 0.1F, 0.1F}), 2), 0U);
  }
}

TEST(CellGridTest, ClustersAreApartThoughPointsAreFar) {
  const Points points = {{0, 0, 0}, {90, 90, 90}, {0, 0, 0.03F}, {0, 0, 0.01F}, {90, 90, 90.01F}};
  EXPECT_THAT(FindClusters(points, 0.015, 1),
              ElementsAre(ElementsAre(0, 3), ElementsAre(1, 4), ElementsAre(2)));
}

// The definition of statistical outlier removal, word for word.
Indices KeptByDefinition(const Points& points, std::size_t count, double factor) {
  std::vector<double> means;
  for (const auto& p : points) {
    std::vector<double> distances;
    for (const auto& q : points) distances.push_back(static_cast<double>((p - q).norm()));
    std::ranges::sort(distances);
    means.push_back(std::accumulate(distances.begin() + 1,
                                    distances.begin() + 1 + static_cast<std::ptrdiff_t>(count),
                                    0.0) /
                    static_cast<double>(count));
  }
  const auto size = static_cast<double>(points.size());
  const double mean = std::accumulate(means.begin(), means.end(), 0.0) / size;
  double squares = 0;
  for (const double m : means) squares += (m - mean) * (m - mean);
  const double limit = mean + factor * std::sqrt(squares / (size - 1));
  Indices out;
  for (std::size_t i = 0; i < means.size(); ++i) {
    if (means[i] <= limit) out.push_back(static_cast<std::int32_t>(i));
  }
  return out;
}

TEST(CellGridTest, OutliersAreThoseOfTheDefinition) {
  Random random(3);
  for (const double size : {0.04, 0.4, 6.0}) {
    Points points = RandomPoints(random, 400, size);
    const Points stray = RandomPoints(random, 12, 8 * size);
    points.insert(points.end(), stray.begin(), stray.end());
    const Indices kept = RemoveStatisticalOutliers(points, 20, 1.5).value();
    EXPECT_EQ(kept, KeptByDefinition(points, 20, 1.5));
    EXPECT_LT(kept.size(), points.size());
  }
}

TEST(CellGridTest, OutliersOfARasterAreThoseOfTheDefinitionThoughDistancesAreEqual) {
  Points points;
  for (int i = 0; i < 400; ++i) {
    const int row = i / 20;
    const int column = i % 20;
    points.emplace_back(0.001F * static_cast<float>(column), 0.001F * static_cast<float>(row), 0);
  }
  points.emplace_back(0.1F, 0.1F, 0.1F);
  const Indices kept = RemoveStatisticalOutliers(points, 30, 3).value();
  EXPECT_THAT(kept, SizeIs(400));
}

}  // namespace
}  // namespace graspdb::recognition
