#include "recognition/outliers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "recognition/cell_grid.h"
#include "recognition/wide.h"

namespace graspdb::recognition {
namespace {

// Cells in which the density of points is estimated, m.
constexpr float kProbeCellM = 0.008F;
// A cell's edge, as a multiple of the radius within which the neighbours probably are.
constexpr double kCellsPerRadius = 1.15;
// Guesses of a distance before all are sorted.
constexpr int kGuesses = 24;

// Edge of cells of which 27 mostly hold the `count` nearest neighbours, were the points evenly
// spread over a surface.
float CellSizeFor(const Points& points, std::size_t count) {
  const CellGrid probe(points, kProbeCellM);
  const double occupied = static_cast<double>(probe.OccupiedCells().size());
  const double per_area = static_cast<double>(points.size()) /
                          (occupied * static_cast<double>(probe.cell_m() * probe.cell_m()));
  const double radius = std::sqrt(static_cast<double>(count) / (per_area * std::numbers::pi));
  return static_cast<float>(kCellsPerRadius * radius);
}

// Sums the roots of the smallest of some values.
class RootsOfSmallest {
 public:
  // Of the `wanted` smallest of `values` (padded with huge ones), of which `known` are not
  // larger than `most`; wanted <= known.
  float Sum(const std::vector<float>& values, std::size_t wanted, float most, std::size_t known) {
    float low = 0;  // fewer than `wanted` are not larger
    std::size_t below = 0;
    float high = most;
    std::size_t within = known;
    float guess = guess_;
    for (int i = 0; i < kGuesses && within > wanted; ++i) {
      // Points on a surface: their number grows with the squared distance.
      const auto share =
          (static_cast<float>(wanted - below) + 0.5F) / (static_cast<float>(within - below) + 1);
      if (i > 0 || !(guess > low && guess < high)) guess = low + (high - low) * share;
      const std::size_t count = wide_.count_up_to(values.data(), values.size(), guess);
      (count < wanted ? low : high) = guess;
      (count < wanted ? below : within) = count;
    }
    guess_ = high;
    if (within == wanted) return wide_.sum_roots_up_to(values.data(), values.size(), high);
    return SumSorted(values, wanted);
  }

 private:
  // Where several have the distance that decides.
  float SumSorted(const std::vector<float>& values, std::size_t wanted) {
    sorted_ = values;
    const auto end = sorted_.begin() + static_cast<std::ptrdiff_t>(wanted);
    std::partial_sort(sorted_.begin(), end, sorted_.end());
    float sum = 0;
    for (auto v = sorted_.begin(); v != end; ++v) sum += std::sqrt(*v);
    return sum;
  }

  const wide::Functions& wide_ = wide::Best();
  float guess_ = -1;  // what the last one ended with: neighbours resemble each other
  std::vector<float> sorted_;
};

// For each point the sum of the distances to its `count` nearest, of which it is one.
class SumsOfNearest {
 public:
  SumsOfNearest(const Points& points, std::size_t count)
      : points_(points), count_(count), grid_(points, CellSizeFor(points, count)) {
    sums_.resize(points.size());
    for (const CellGrid::Cell& cell : grid_.OccupiedCells()) SumCell(cell);
  }

  std::vector<float> Take() { return std::move(sums_); }

 private:
  void SumCell(const CellGrid::Cell& cell) {
    const auto begin = grid_.order().begin();
    open_.assign(begin + cell.begin, begin + cell.end);
    for (int reach = 1; !open_.empty(); reach *= 2) {
      grid_.Gather(cell.at, reach, &block_);
      squared_.resize(block_.x.size());
      std::erase_if(open_, [&](std::int32_t i) { return Sum(static_cast<std::size_t>(i)); });
    }
  }

  // False where neighbours of the point may lie outside of the block.
  bool Sum(std::size_t point) {
    const Eigen::Vector3f& p = points_[point];
    wide_.squared_distances(block_.coordinates(), p.data(), squared_.data());
    const float coverage = std::clamp(block_.Coverage(p), 0.0F, 0.1F * wide::kFar);
    const float most = coverage * coverage;
    const std::size_t known = wide_.count_up_to(squared_.data(), squared_.size(), most);
    if (known < count_) return false;
    sums_[point] = roots_.Sum(squared_, count_, most, known);
    return true;
  }

  const wide::Functions& wide_ = wide::Best();
  const Points& points_;
  const std::size_t count_;
  const CellGrid grid_;
  RootsOfSmallest roots_;
  CellBlock block_;
  Indices open_;
  std::vector<float> squared_;
  std::vector<float> sums_;
};

}  // namespace

Indices RemoveStatisticalOutliers(const Points& points, int neighbor_count,
                                  double deviation_factor) {
  Indices kept(points.size());
  std::iota(kept.begin(), kept.end(), 0);
  if (neighbor_count <= 0 || points.size() <= static_cast<std::size_t>(neighbor_count)) return kept;

  const std::vector<float> sums =
      SumsOfNearest(points, static_cast<std::size_t>(neighbor_count) + 1).Take();
  std::vector<double> mean_distance(points.size());
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    mean_distance[i] = static_cast<double>(sums[i]) / neighbor_count;
    sum += mean_distance[i];
    squares += mean_distance[i] * mean_distance[i];
  }
  const auto count = static_cast<double>(points.size());
  const double variance = std::max(0.0, (squares - sum * sum / count) / (count - 1));
  const double limit = sum / count + deviation_factor * std::sqrt(variance);
  std::erase_if(kept,
                [&](std::int32_t i) { return mean_distance[static_cast<std::size_t>(i)] > limit; });
  return kept;
}

}  // namespace graspdb::recognition
