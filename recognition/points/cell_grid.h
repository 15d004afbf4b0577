// Points sorted into cubic cells: the one structure behind outliers, clusters and normals.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"
#include "recognition/simd/kernels.h"

namespace graspdb::recognition {

// The points of a cube of cells, copied so that SIMD code can read them. Kept between calls, it
// allocates nothing in the long run.
struct CellBlock {
  std::vector<float> x;  // padded with kFar
  std::vector<float> y;
  std::vector<float> z;
  // All points of the cloud that are nearer than its faces are in the block; faces that nothing
  // lies beyond are infinitely far away.
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  Eigen::Vector3f high = Eigen::Vector3f::Zero();

  simd::Coordinates coordinates() const { return {x.data(), y.data(), z.data(), x.size()}; }
  // How far around `p` all points are known, m.
  float Coverage(const Eigen::Vector3f& p) const {
    return std::min((p - low).minCoeff(), (high - p).minCoeff());
  }
};

// Memory grows with the points: where a table of all cells would be larger than 16 MB, only
// occupied cells are listed, and a look-up takes a binary search in a bucket of neighbours.
// Building is O(n) with a table and O(n log n) with a list. Deterministic; safe for concurrent
// reads. Points must be finite and within 1 km of the origin; metres, any frame.
class CellGrid {
 public:
  // One occupied cell.
  struct Cell {
    Eigen::Vector3i at;  // along x, y, z; cells, from the one with the lowest coordinates
    std::int32_t begin;  // in order()
    std::int32_t end;
  };

  // Cells of edge `cell_m`; larger ones only where an axis would have more than two million. Once
  // cancelled, a grid without points.
  CellGrid(const Points& points, float cell_m, const IsCancelled& is_cancelled = {});

  float cell_m() const { return cell_m_; }
  // The points cell by cell, those of a cell in the order of the cloud.
  const std::vector<std::int32_t>& order() const { return order_; }
  // By z, y, x. None once cancelled.
  std::vector<Cell> OccupiedCells(const IsCancelled& is_cancelled = {}) const;

  // The points of the cells up to `reach` cells away from `at` along each axis.
  void Gather(const Eigen::Vector3i& at, int reach, CellBlock* out) const;

  // How many points those are.
  std::size_t CountAround(const Eigen::Vector3i& at, int reach) const {
    std::size_t count = 0;
    ForEachRange(at, reach, [&](std::int32_t begin, std::int32_t end) {
      count += static_cast<std::size_t>(end - begin);
    });
    return count;
  }

  // The cell of a place; outside of the grid the nearest.
  Eigen::Vector3i CellOf(const Eigen::Vector3f& p) const {
    return ((p - origin_) * inverse_cell_)
        .array()
        .max(0)
        .min(last_.cast<float>().array())
        .cast<int>();
  }

  // Calls visit(begin, end), ranges of order(), for the cells up to `reach` away.
  template <typename Visit>
  void ForEachRange(const Eigen::Vector3i& at, int reach, Visit&& visit) const {
    const Eigen::Vector3i low = (at.array() - reach).max(0);
    const Eigen::Vector3i high = (at.array() + reach).min(last_.array());
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        // Cells of a row follow each other.
        const std::int32_t begin = BeginAtKey(KeyOf({low.x(), y, z}));
        const std::int32_t end = BeginAtKey(KeyOf({high.x(), y, z}) + 1);
        if (begin < end) visit(begin, end);
      }
    }
  }

  // Calls visit(i), an index into the cloud, for the points of the cells up to `reach` away from
  // that of `p`.
  template <typename Visit>
  void ForEachPoint(const Eigen::Vector3f& p, int reach, Visit&& visit) const {
    ForEachRange(CellOf(p), reach, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t at = begin; at < end; ++at) {
        visit(static_cast<std::size_t>(order_[static_cast<std::size_t>(at)]));
      }
    });
  }

 private:
  // By z, y, x.
  std::uint64_t KeyOf(const Eigen::Vector3i& c) const {
    return (static_cast<std::uint64_t>(c.z()) * (static_cast<std::uint64_t>(last_.y()) + 1) +
            static_cast<std::uint64_t>(c.y())) *
               (static_cast<std::uint64_t>(last_.x()) + 1) +
           static_cast<std::uint64_t>(c.x());
  }
  // In order_: of the first point in the cell of `key` or one behind it.
  std::int32_t BeginAtKey(std::uint64_t key) const {
    if (keys_.empty()) return start_[key];
    const auto bucket = static_cast<std::size_t>(key >> bucket_bits_);
    const auto at = std::lower_bound(keys_.begin() + first_in_bucket_[bucket],
                                     keys_.begin() + first_in_bucket_[bucket + 1], key);
    return start_[static_cast<std::size_t>(at - keys_.begin())];
  }
  // False once cancelled.
  bool Fill(const Points& points, const IsCancelled& is_cancelled);
  bool MakeTable(const Points& points, std::size_t cell_count, CancellationPoll* poll);
  bool MakeList(const Points& points, const IsCancelled& is_cancelled, CancellationPoll* poll);
  void MakeBuckets();

  float cell_m_;
  float inverse_cell_ = 0;
  Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
  Eigen::Vector3i last_ = Eigen::Vector3i::Zero();  // the cell farthest from the origin
  std::vector<std::uint64_t> keys_;                 // of the occupied cells; none: of all cells
  int bucket_bits_ = 0;                             // keys that differ in higher ones lie apart
  std::vector<std::int32_t> first_in_bucket_;       // position in keys_
  std::vector<std::int32_t> start_;                 // of each cell in order_, and the end
  std::vector<std::int32_t> order_;
  std::array<std::vector<float>, 3> sorted_;  // coordinates of the points, in that order
};

}  // namespace graspdb::recognition
