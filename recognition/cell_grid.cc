#include "recognition/cell_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "recognition/bounds.h"

namespace graspdb::recognition {
namespace {

// Four bytes each.
constexpr double kMostCells = 4e6;

}  // namespace

CellGrid::CellGrid(const Points& points, float cell_m) : cell_m_(cell_m) {
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();
  if (!points.empty()) {
    const Eigen::AlignedBox3f bounds = BoundsOf(points);
    origin_ = bounds.min();
    extent = bounds.sizes().cast<double>();
  }
  const auto cells = [&](double edge) { return ((extent / edge).array().floor() + 1).prod(); };
  while (cells(static_cast<double>(cell_m_)) > kMostCells) cell_m_ *= 1.5F;
  inverse_cell_ = 1 / cell_m_;
  last_ = (extent / static_cast<double>(cell_m_)).array().floor().cast<int>();

  start_.assign(Offset(last_) + 2, 0);
  std::vector<std::uint32_t> cell_of(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t cell = Offset(CellOf(points[i]));
    cell_of[i] = static_cast<std::uint32_t>(cell);
    ++start_[cell + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  order_.resize(points.size());
  // From the back, so that each cell's end moves to its beginning.
  for (std::size_t i = points.size(); i-- > 0;) {
    order_[static_cast<std::size_t>(--start_[cell_of[i] + 1])] = static_cast<std::int32_t>(i);
  }
  // start_[c + 1] is now where cell c begins.
  std::move(start_.begin() + 1, start_.end(), start_.begin());
  start_.back() = static_cast<std::int32_t>(points.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sorted_[axis].reserve(points.size());
    for (const std::int32_t i : order_) {
      sorted_[axis].push_back(points[static_cast<std::size_t>(i)][static_cast<Eigen::Index>(axis)]);
    }
  }
}

std::vector<CellGrid::Cell> CellGrid::OccupiedCells() const {
  std::vector<Cell> out;
  std::size_t cell = 0;
  for (int z = 0; z <= last_.z(); ++z) {
    for (int y = 0; y <= last_.y(); ++y) {
      for (int x = 0; x <= last_.x(); ++x, ++cell) {
        if (start_[cell] < start_[cell + 1]) {
          out.push_back({{x, y, z}, start_[cell], start_[cell + 1]});
        }
      }
    }
  }
  return out;
}

void CellGrid::Gather(const Eigen::Vector3i& at, int reach, CellBlock* out) const {
  std::size_t count = 0;
  ForEachRange(at, reach, [&](std::int32_t begin, std::int32_t end) {
    count += static_cast<std::size_t>(end - begin);
  });
  const std::size_t padded = wide::Padded(count);
  std::array<std::vector<float>*, 3> to = {&out->x, &out->y, &out->z};
  for (auto* axis : to) {
    axis->resize(padded);
    std::fill(axis->begin() + static_cast<std::ptrdiff_t>(count), axis->end(), wide::kFar);
  }
  std::size_t filled = 0;
  ForEachRange(at, reach, [&](std::int32_t begin, std::int32_t end) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::copy(sorted_[axis].begin() + begin, sorted_[axis].begin() + end,
                to[axis]->begin() + static_cast<std::ptrdiff_t>(filled));
    }
    filled += static_cast<std::size_t>(end - begin);
  });
  constexpr float kNone = std::numeric_limits<float>::infinity();
  // Rounding may have put a point into the cell beyond its face.
  const float margin = 1e-4F * cell_m_;
  for (int axis = 0; axis < 3; ++axis) {
    const int first = at[axis] - reach;
    const int last = at[axis] + reach;
    out->low[axis] =
        first <= 0 ? -kNone : origin_[axis] + static_cast<float>(first) * cell_m_ + margin;
    out->high[axis] = last >= last_[axis]
                          ? kNone
                          : origin_[axis] + static_cast<float>(last + 1) * cell_m_ - margin;
  }
}

}  // namespace graspdb::recognition
