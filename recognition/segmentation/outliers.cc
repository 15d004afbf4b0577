#include "recognition/segmentation/outliers.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>

#include "recognition/base/grow.h"
#include "recognition/base/idle_cores.h"
#include "recognition/points/cell_grid.h"
#include "recognition/simd/kernels.h"

namespace graspdb::recognition {
namespace {

// Cells in which the density of points is estimated, m.
constexpr float kProbeCellM = 0.008F;
// A cell's edge, as a multiple of the radius within which the neighbours probably are.
constexpr double kCellsPerRadius = 1.15;
// Gathered cells to each side of a point; for farther points larger cells are cheaper.
constexpr int kMaxReach = 4;
constexpr float kCoarser = 8;
// Distances that are computed in all, about 0.5 s: a frame of two million points on surfaces takes
// nine tenths of them.
constexpr std::size_t kMaxWork = 750'000'000;
// Cost of finding a row of cells, in distances.
constexpr std::size_t kWorkPerRow = 32;
// Portions in which idle threads sum the cells.
constexpr std::size_t kChunks = 16;
// No camera measures nearer points, m.
constexpr float kMinRangeM = 0.01F;
// Guesses of a distance before all are sorted.
constexpr int kGuesses = 24;

// Edge of cells of which 27 mostly contain the `count` nearest neighbours, for points evenly spread
// over a surface.
float CellSizeFor(const Points& points, std::size_t count, const IsCancelled& is_cancelled) {
  const CellGrid probe(points, kProbeCellM, is_cancelled);
  const double occupied =
      static_cast<double>(std::max<std::size_t>(1, probe.OccupiedCells(is_cancelled).size()));
  const double per_area = static_cast<double>(points.size()) /
                          (occupied * static_cast<double>(probe.cell_m() * probe.cell_m()));
  const double radius = std::sqrt(static_cast<double>(count) / (per_area * std::numbers::pi));
  return static_cast<float>(kCellsPerRadius * radius);
}

// Sums the roots of the smallest of some values.
class RootsOfSmallest {
 public:
  // Of the `wanted` smallest of `values` (padded with huge ones), of which `known` are not larger
  // than `limit`; wanted <= known.
  float Sum(const std::vector<float>& values, std::size_t wanted, float limit, std::size_t known) {
    float low = 0;  // fewer than `wanted` are not larger
    std::size_t below = 0;
    float high = limit;
    std::size_t within = known;
    float guess = guess_;
    for (int i = 0; i < kGuesses && within > wanted; ++i) {
      // Points on a surface: their number grows with the squared distance.
      const auto share =
          (static_cast<float>(wanted - below) + 0.5F) / (static_cast<float>(within - below) + 1);
      if (i > 0 || !(guess > low && guess < high)) guess = low + (high - low) * share;
      const std::size_t count = kernels_.count_up_to(values.data(), values.size(), guess);
      (count < wanted ? low : high) = guess;
      (count < wanted ? below : within) = count;
    }
    guess_ = high;
    if (within == wanted) return kernels_.sum_roots_up_to(values.data(), values.size(), high);
    return SumSorted(values, wanted);
  }

 private:
  // For ties of the deciding distance.
  float SumSorted(const std::vector<float>& values, std::size_t wanted) {
    sorted_ = values;
    const auto end = sorted_.begin() + static_cast<std::ptrdiff_t>(wanted);
    std::partial_sort(sorted_.begin(), end, sorted_.end());
    float sum = 0;
    for (auto v = sorted_.begin(); v != end; ++v) sum += std::sqrt(*v);
    return sum;
  }

  const simd::Functions& kernels_ = simd::Best();
  float guess_ = -1;  // result of the last call: neighbours resemble each other
  std::vector<float> sorted_;
};

// Sums of the distances of some points to their `count` nearest, including themselves.
class SumsOfNearest {
 public:
  SumsOfNearest(const Points& points, std::size_t count, const IsCancelled& is_cancelled)
      : points_(points), count_(count), is_cancelled_(is_cancelled) {}

  // Of all points; none when that takes too long.
  std::optional<std::vector<float>> Take() {
    CancellationPoll poll(is_cancelled_);
    Indices open;
    if (!GrowTo(points_.size(), &poll, &sums_) || !GrowTo(points_.size(), &poll, &open)) {
      return std::nullopt;
    }
    std::iota(open.begin(), open.end(), 0);
    // Points for which a grid's cells are too small are left to one with larger cells.
    float cell_m = CellSizeFor(points_, count_, is_cancelled_);
    for (; !open.empty(); cell_m *= kCoarser) {
      if (is_cancelled_() || !SumWith(CellGrid(points_, cell_m, is_cancelled_), &open)) {
        return std::nullopt;
      }
    }
    return std::move(sums_);
  }

 private:
  // Buffers of one thread.
  struct Scratch {
    explicit Scratch(const IsCancelled& is_cancelled) : poll(is_cancelled) {}

    CancellationPoll poll;
    RootsOfSmallest roots;
    CellBlock block;
    Indices in_cell;
    std::vector<float> squared;
    Indices left;
  };

  // Leaves in `open` the points that have no sum yet; false when it takes too long.
  bool SumWith(const CellGrid& grid, Indices* open) {
    CancellationPoll poll(is_cancelled_);
    is_open_.clear();
    if (!GrowTo(points_.size(), &poll, &is_open_)) return false;
    for (const std::int32_t i : *open) is_open_[static_cast<std::size_t>(i)] = 1;
    open->clear();
    const std::vector<CellGrid::Cell> cells = grid.OccupiedCells(is_cancelled_);
    std::vector<Indices> left(kChunks);
    std::atomic<bool> done = true;
    ForEachIndex(kChunks, [&](std::size_t chunk) {
      Scratch scratch(is_cancelled_);
      const std::size_t end = (chunk + 1) * cells.size() / kChunks;
      for (std::size_t i = chunk * cells.size() / kChunks; i < end && done; ++i) {
        if (!SumCell(grid, cells[i], &scratch)) done = false;
      }
      left[chunk] = std::move(scratch.left);
    });
    for (const Indices& some : left) open->insert(open->end(), some.begin(), some.end());
    return done;
  }

  bool SumCell(const CellGrid& grid, const CellGrid::Cell& cell, Scratch* scratch) {
    Indices& in_cell = scratch->in_cell;
    in_cell.clear();
    for (std::int32_t at = cell.begin; at < cell.end; ++at) {
      const std::int32_t i = grid.order()[static_cast<std::size_t>(at)];
      if (is_open_[static_cast<std::size_t>(i)] != 0) in_cell.push_back(i);
    }
    for (int reach = 1; reach <= kMaxReach && !in_cell.empty(); reach *= 2) {
      const std::size_t count = grid.CountAround(cell.at, reach);
      const auto rows =
          static_cast<std::size_t>(2 * reach + 1) * static_cast<std::size_t>(2 * reach + 1);
      const std::size_t work = count * (in_cell.size() + 1) + kWorkPerRow * rows;
      if (work_ += work; work_ > kMaxWork || scratch->poll.AfterDistances(work)) return false;
      if (count < count_) continue;
      grid.Gather(cell.at, reach, &scratch->block);
      scratch->squared.resize(scratch->block.x.size());
      std::erase_if(in_cell,
                    [&](std::int32_t i) { return Sum(static_cast<std::size_t>(i), scratch); });
    }
    scratch->left.insert(scratch->left.end(), in_cell.begin(), in_cell.end());
    return true;
  }

  // False where neighbours of the point may lie outside of the block.
  bool Sum(std::size_t point, Scratch* scratch) {
    const Eigen::Vector3f& p = points_[point];
    std::vector<float>& squared = scratch->squared;
    kernels_.squared_distances(scratch->block.coordinates(), p.data(), squared.data());
    const float coverage = std::clamp(scratch->block.Coverage(p), 0.0F, 0.1F * simd::kFar);
    const float limit = coverage * coverage;
    const std::size_t known = kernels_.count_up_to(squared.data(), squared.size(), limit);
    if (known < count_) return false;
    sums_[point] = scratch->roots.Sum(squared, count_, limit, known);
    return true;
  }

  const simd::Functions& kernels_ = simd::Best();
  const Points& points_;
  const std::size_t count_;
  const IsCancelled& is_cancelled_;
  // Of all threads: whether it exceeds the limit does not depend on their order.
  std::atomic<std::size_t> work_ = 0;
  std::vector<char> is_open_;
  std::vector<float> sums_;
};

}  // namespace

std::optional<Indices> RemoveStatisticalOutliers(const Points& points, int neighbor_count,
                                                 double deviation_factor,
                                                 const IsCancelled& cancelled_by_caller,
                                                 const Eigen::Vector3f* viewpoint) {
  const IsCancelled is_cancelled = Latched(cancelled_by_caller);
  Indices kept;
  CancellationPoll poll(is_cancelled);
  if (!GrowTo(points.size(), &poll, &kept)) return std::nullopt;
  std::iota(kept.begin(), kept.end(), 0);
  if (neighbor_count <= 0 || points.size() <= static_cast<std::size_t>(neighbor_count)) return kept;

  const std::optional<std::vector<float>> sums =
      SumsOfNearest(points, static_cast<std::size_t>(neighbor_count) + 1, is_cancelled).Take();
  if (!sums) return std::nullopt;
  std::vector<double> mean_distance;
  if (!GrowTo(points.size(), &poll, &mean_distance)) return std::nullopt;
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    mean_distance[i] = static_cast<double>((*sums)[i]) / neighbor_count;
    if (viewpoint != nullptr) {
      const float range = (points[i] - *viewpoint).norm();
      mean_distance[i] /= static_cast<double>(std::max(range, kMinRangeM));
    }
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
