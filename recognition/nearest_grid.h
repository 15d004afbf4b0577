// Nearest points by look-up instead of search.
#pragma once

#include <cstdint>
#include <vector>

#include "recognition/types.h"

namespace graspdb::recognition {

// A grid of cells around `points`, each of which knows the point nearest to its centre. A query
// costs one look-up; the point that it gives may be farther than the nearest by up to a cell's
// diagonal. Exact enough where residuals are measured against the tangent plane there.
// Deterministic; safe for concurrent queries.
class NearestGrid {
 public:
  // Cells of `cell_m` metres whose centres are up to `reach_m` metres (and half a cell's diagonal)
  // away from a point know one.
  NearestGrid(const Points& points, float cell_m, float reach_m);

  // The position of the nearest point; -1 when there is none within reach.
  int Nearest(const Eigen::Vector3f& query) const {
    const float x = (query.x() - origin_.x()) * inverse_cell_;
    const float y = (query.y() - origin_.y()) * inverse_cell_;
    const float z = (query.z() - origin_.z()) * inverse_cell_;
    const bool inside = x >= 0 && x < limit_.x() && y >= 0 && y < limit_.y() && z >= 0 &&
                        z < limit_.z();  // false for what is not a number
    if (!inside) return -1;
    return cells_[Offset(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z))];
  }

  std::size_t bytes() const { return cells_.size() * sizeof(cells_[0]); }

 private:
  std::size_t Offset(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(y)) *
               row_ +
           static_cast<std::size_t>(x);
  }

  Indices OneEachCell(const Points& points) const;

  Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  Eigen::Vector3f limit_ = Eigen::Vector3f::Zero();  // size_ as floats
  std::size_t row_ = 0;  // cells between the beginnings of rows: some more than size_.x()
  float cell_m_;
  float inverse_cell_;
  std::vector<std::int32_t> cells_;
};

}  // namespace graspdb::recognition
