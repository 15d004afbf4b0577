// Points sorted into cubic cells: the one structure behind outliers, clusters and normals.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "recognition/types.h"
#include "recognition/wide.h"

namespace graspdb::recognition {

// The points of a cube of cells, copied so that wide code can read them. Kept between calls, it
// allocates nothing in the long run.
struct CellBlock {
  std::vector<float> x;  // padded with kFar
  std::vector<float> y;
  std::vector<float> z;
  // All points of the cloud that are nearer than its faces are in the block; faces that nothing
  // lies beyond are infinitely far away.
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  Eigen::Vector3f high = Eigen::Vector3f::Zero();

  wide::Coordinates coordinates() const { return {x.data(), y.data(), z.data(), x.size()}; }
  // How far around `p` all points are known, m.
  float Coverage(const Eigen::Vector3f& p) const {
    return std::min((p - low).minCoeff(), (high - p).minCoeff());
  }
};

// Deterministic; safe for concurrent reads. Points must be finite; metres, any frame.
class CellGrid {
 public:
  // One occupied cell.
  struct Cell {
    Eigen::Vector3i at;  // along x, y, z; cells, from the one with the lowest coordinates
    std::int32_t begin;  // in order()
    std::int32_t end;
  };

  // Cells of edge `cell_m`, larger ones where there would be too many of them for the memory.
  CellGrid(const Points& points, float cell_m);

  float cell_m() const { return cell_m_; }
  // The points cell by cell, those of a cell in the order of the cloud.
  const std::vector<std::int32_t>& order() const { return order_; }
  // By z, y, x.
  std::vector<Cell> OccupiedCells() const;

  // The points of the cells up to `reach` cells away from `at` along each axis.
  void Gather(const Eigen::Vector3i& at, int reach, CellBlock* out) const;

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
        const std::int32_t begin = start_[Offset({low.x(), y, z})];
        const std::int32_t end = start_[Offset({high.x(), y, z}) + 1];
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
  std::size_t Offset(const Eigen::Vector3i& c) const {
    return (static_cast<std::size_t>(c.z()) * static_cast<std::size_t>(last_.y() + 1) +
            static_cast<std::size_t>(c.y())) *
               static_cast<std::size_t>(last_.x() + 1) +
           static_cast<std::size_t>(c.x());
  }

  float cell_m_;
  float inverse_cell_ = 0;
  Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
  Eigen::Vector3i last_ = Eigen::Vector3i::Zero();  // the cell farthest from the origin
  std::vector<std::int32_t> start_;                 // of each cell in order_, and the end
  std::vector<std::int32_t> order_;
  std::array<std::vector<float>, 3> sorted_;  // coordinates of the points, in that order
};

}  // namespace graspdb::recognition
