#include "recognition/nearest_grid.h"

#include <algorithm>
#include <cmath>

#include "recognition/bounds.h"
#include "recognition/wide.h"

namespace graspdb::recognition {
namespace {

// The rows of cells of which some are at most `reach` cells away from a point in the middle one.
std::vector<wide::BallRow> RowsWithin(float reach) {
  std::vector<wide::BallRow> out;
  const int most = static_cast<int>(std::ceil(reach));
  // The point may be anywhere in its cell.
  const auto nearest = [](int cells) {
    return std::max(0.0F, std::abs(static_cast<float>(cells)) - 0.5F);
  };
  for (int z = -most; z <= most; ++z) {
    for (int y = -most; y <= most; ++y) {
      const float rest = reach * reach - nearest(z) * nearest(z) - nearest(y) * nearest(y);
      if (rest < 0) continue;
      out.push_back({z, y, std::min(most, static_cast<int>(std::ceil(std::sqrt(rest) + 0.5F)))});
    }
  }
  return out;
}

}  // namespace

NearestGrid::Level::Level(const Points& points, float cell_m, float reach_m)
    : inverse_cell_(1 / cell_m) {
  if (points.empty()) return;
  const Eigen::AlignedBox3f bounds = BoundsOf(points);
  const int layers = static_cast<int>(std::ceil(reach_m / cell_m));
  origin_ = bounds.min().array() - static_cast<float>(layers + 1) * cell_m;
  const Eigen::Vector3f cells = bounds.sizes() * inverse_cell_;
  size_ = cells.array().floor().cast<int>() + 2 * layers + 3;
  // Wide code may write a whole step from any cell on.
  row_ = wide::Padded(static_cast<std::size_t>(size_.x())) + wide::kLanes;
  cells_.assign(row_ * static_cast<std::size_t>(size_.y()) * static_cast<std::size_t>(size_.z()),
                -1);
  const float far = reach_m + std::sqrt(0.75F) * cell_m;
  std::vector<float> best(cells_.size(), far * far);
  const std::vector<wide::BallRow> rows = RowsWithin(far * inverse_cell_);
  const wide::Cells all = {size_.data(), row_, cell_m, best.data(), cells_.data()};
  for (const std::int32_t i : OneEachCell(points)) {
    const Eigen::Array3f at = Place(points[static_cast<std::size_t>(i)]);
    wide::Best().spread(rows.data(), rows.size(), at.data(), i, all);
  }
}

// Of the points in one cell the nearest to its centre stands for all of them.
Indices NearestGrid::Level::OneEachCell(const Points& points) const {
  std::vector<std::int32_t> in_cell(cells_.size(), -1);
  Indices occupied;
  const auto place = [&](std::int32_t i) { return Place(points[static_cast<std::size_t>(i)]); };
  const auto off = [](const Eigen::Array3f& at) {
    return (at - at.floor() - 0.5F).matrix().squaredNorm();
  };
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(points.size()); ++i) {
    const Eigen::Array3f at = place(i);
    const std::size_t cell = CellOf(at);
    std::int32_t& known = in_cell[cell];
    if (known < 0) occupied.push_back(static_cast<std::int32_t>(cell));
    if (known < 0 || off(at) < off(place(known))) known = i;
  }
  for (std::int32_t& cell : occupied) cell = in_cell[static_cast<std::size_t>(cell)];
  return occupied;
}

wide::NearestCells NearestGrid::Level::cells() const {
  wide::NearestCells out;
  out.nearest = cells_.data();
  Eigen::Map<Eigen::Vector3f>(out.origin) = origin_;
  out.inverse_cell = inverse_cell_;
  Eigen::Map<Eigen::Vector3f>(out.size) = size_.cast<float>();
  out.row = static_cast<std::int32_t>(row_);
  out.layer = static_cast<std::int32_t>(row_) * size_.y();
  return out;
}

NearestGrid::NearestGrid(const Points& points, float cell_m, float reach_m)
    : near_(points, cell_m, 2 * cell_m), far_(points, 2 * cell_m, reach_m) {}

wide::LookUp NearestGrid::LookUpIn(const OrientedCloud& cloud) const {
  return {.near = near_.cells(),
          .far = far_.cells(),
          .points = cloud.points.empty() ? nullptr : cloud.points.front().data(),
          .normals = cloud.normals.empty() ? nullptr : cloud.normals.front().data()};
}

}  // namespace graspdb::recognition
