// Nearest points by look-up instead of search.
#pragma once

#include <cstdint>
#include <vector>

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"
#include "recognition/simd/surface_kernels.h"

namespace graspdb::recognition {

// Cells around `points`, each of which stores the point nearest to its centre: small ones near the
// points, and twice as large ones as far as the grid reaches. A query costs one or two look-ups;
// the result may be farther than the nearest point by up to a cell's diagonal. Exact enough where
// residuals are measured against the tangent plane there. Metres, any frame. Deterministic; safe
// for concurrent queries.
//
// Cells are kept in blocks, and only blocks that a point reaches: memory and time to build grow
// with the points, not with the volume between them. 64 MB at most while it is built, 36 MB after
// that for each size of cells: points that are so scattered that they would need more get cells
// twice as large, as often as it takes. Points must be finite. Once cancelled, some cells store no
// point.
class NearestGrid {
 public:
  // Small cells of `cell_m` metres store a point up to twice as far from their centres, and large
  // ones one up to `reach_m` metres away (and half a cell's diagonal).
  NearestGrid(const Points& points, float cell_m, float reach_m,
              const IsCancelled& is_cancelled = {});

  // The position of the nearest point; -1 when there is none within reach.
  int Nearest(const Eigen::Vector3f& query) const {
    const int near = near_.Nearest(query);
    return near >= 0 ? near : far_.Nearest(query);
  }

  // For SIMD code: this grid, which must be over `cloud`; both must outlive the result.
  simd::LookUp LookUpIn(const OrientedCloud& cloud) const;

  std::size_t bytes() const { return near_.bytes() + far_.bytes(); }

 private:
  // Cells of one size.
  class Level {
   public:
    Level(const Points& points, float cell_m, float reach_m, const IsCancelled& is_cancelled);

    int Nearest(const Eigen::Vector3f& query) const {
      const Eigen::Array3f at = Place(query);
      // False for NaN.
      const bool inside = (at >= 0).all() && (at < size_.cast<float>().array()).all();
      return inside ? cells_[CellOf(at)] : -1;
    }
    simd::NearestCells cells() const;
    std::size_t bytes() const { return (cells_.size() + blocks_.size()) * sizeof(cells_[0]); }

   private:
    Eigen::Array3f Place(const Eigen::Vector3f& p) const { return (p - origin_) * inverse_cell_; }
    std::size_t CellOf(const Eigen::Array3f& place) const {
      const Eigen::Array3i at = place.cast<int>();
      const std::int32_t block = blocks_[static_cast<std::size_t>(simd::BlockOf(table(), at))];
      return static_cast<std::size_t>(block) + static_cast<std::size_t>(simd::CellInBlock(at));
    }
    simd::BlockTable table() const {
      return {blocks_.data(), block_count_.x(), block_count_.x() * block_count_.y()};
    }
    // Whether cells of that size fit the limits; if so, their blocks are there, or all of them are
    // the empty one where the search was cancelled.
    bool Allocate(const Points& points, float cell_m, float reach_m, CancellationPoll& poll);
    Indices OneEachCell(const Points& points, CancellationPoll& poll);

    Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
    Eigen::Vector3i size_ = Eigen::Vector3i::Zero();  // cells
    Eigen::Vector3i block_count_ = Eigen::Vector3i::Ones();
    float inverse_cell_;
    // Where in cells_ each block begins. That at 0 is empty; all blocks that no point reaches refer
    // to it.
    std::vector<std::int32_t> blocks_ = {0};
    std::vector<std::int32_t> cells_;
  };

  Level near_;
  Level far_;
};

}  // namespace graspdb::recognition
