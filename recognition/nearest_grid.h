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
  // Cells of `cell_m` metres know points up to about `reach_m` metres away.
  NearestGrid(const Points& points, float cell_m, float reach_m);

  // The position of the nearest point; -1 when there is none within reach.
  int Nearest(const Eigen::Vector3f& query) const {
    const Eigen::Vector3f at = (query - origin_) * inverse_cell_;
    if (!(at.array() >= 0).all() || !(at.array() < size_.cast<float>().array()).all()) return -1;
    return cells_[Offset(at.cast<int>())];
  }

  std::size_t bytes() const { return cells_.size() * sizeof(cells_[0]); }

 private:
  std::size_t Offset(const Eigen::Vector3i& c) const {
    return (static_cast<std::size_t>(c.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(c.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(c.x());
  }
  void Seed(const Points& points);
  void Spread(const Points& points, int layers);

  Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  float cell_m_;
  float inverse_cell_;
  std::vector<std::int32_t> cells_;
};

}  // namespace graspdb::recognition
