#include "recognition/points/cell_grid.h"

#include <algorithm>
#include <limits>

#include "recognition/base/bounds.h"
#include "recognition/base/grow.h"
#include "recognition/points/keyed_points.h"

namespace graspdb::recognition {
namespace {

// Maximum number of cells of a table, four bytes each.
constexpr double kMaxTable = 4e6;
// With this many along each axis, keys fit 63 bits; 1 km in cells of 1 mm has half as many.
constexpr double kMaxCellsPerAxis = 2e6;

}  // namespace

CellGrid::CellGrid(const Points& points, float cell_m, const IsCancelled& is_cancelled)
    : cell_m_(cell_m) {
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();
  if (!points.empty()) {
    const Eigen::AlignedBox3f bounds = BoundsOf(points);
    origin_ = bounds.min();
    extent = bounds.sizes().cast<double>();
  }
  cell_m_ = std::max(cell_m_, static_cast<float>(extent.maxCoeff() / kMaxCellsPerAxis));
  inverse_cell_ = 1 / cell_m_;
  last_ = (extent / static_cast<double>(cell_m_)).array().floor().cast<int>();

  if (!Fill(points, is_cancelled)) *this = CellGrid({}, cell_m);
}

bool CellGrid::Fill(const Points& points, const IsCancelled& is_cancelled) {
  CancellationPoll poll(is_cancelled);
  if (!GrowTo(points.size(), &poll, &order_)) return false;
  const double cell_count = (last_.cast<double>().array() + 1).prod();
  if (!(cell_count <= kMaxTable ? MakeTable(points, static_cast<std::size_t>(cell_count), &poll)
                                : MakeList(points, is_cancelled, &poll))) {
    return false;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<float>& sorted = sorted_[axis];
    sorted.reserve(points.size());
    for (const std::int32_t i : order_) {
      if (poll.AfterPoints()) return false;
      sorted.push_back(points[static_cast<std::size_t>(i)][static_cast<Eigen::Index>(axis)]);
    }
  }
  return !poll.Now();
}

bool CellGrid::MakeTable(const Points& points, std::size_t cell_count, CancellationPoll* poll) {
  if (!GrowTo(cell_count + 1, poll, &start_)) return false;
  std::vector<std::uint32_t> cell_of;
  cell_of.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    if (poll->AfterPoints()) return false;
    const auto cell = static_cast<std::size_t>(KeyOf(CellOf(p)));
    cell_of.push_back(static_cast<std::uint32_t>(cell));
    ++start_[cell + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  if (poll->Now()) return false;
  // From the back, so that each cell's end moves to its beginning.
  for (std::size_t i = points.size(); i-- > 0;) {
    if (poll->AfterPoints()) return false;
    order_[static_cast<std::size_t>(--start_[cell_of[i] + 1])] = static_cast<std::int32_t>(i);
  }
  // start_[c + 1] is now where cell c begins.
  std::move(start_.begin() + 1, start_.end(), start_.begin());
  start_.back() = static_cast<std::int32_t>(points.size());
  return true;
}

bool CellGrid::MakeList(const Points& points, const IsCancelled& is_cancelled,
                        CancellationPoll* poll) {
  std::vector<KeyedPoint> sorted;
  sorted.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (poll->AfterPoints()) return false;
    sorted.push_back({KeyOf(CellOf(points[i])), static_cast<std::int32_t>(i)});
  }
  SortByKey(KeyOf(last_), &sorted, is_cancelled);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (poll->AfterPoints()) return false;
    order_[i] = sorted[i].point;
    if (i > 0 && sorted[i].key == sorted[i - 1].key) continue;
    keys_.push_back(sorted[i].key);
    start_.push_back(static_cast<std::int32_t>(i));
  }
  start_.push_back(static_cast<std::int32_t>(points.size()));
  MakeBuckets();
  return true;
}

// About one bucket for each occupied cell, so that most contain few keys.
void CellGrid::MakeBuckets() {
  const std::uint64_t largest = KeyOf(last_);
  while ((largest >> bucket_bits_) > keys_.size()) ++bucket_bits_;
  // One more for the key behind the last.
  const auto count = static_cast<std::size_t>((largest + 1) >> bucket_bits_) + 1;
  first_in_bucket_.reserve(count + 1);
  std::size_t at = 0;
  for (std::size_t bucket = 0; bucket <= count; ++bucket) {
    while (at < keys_.size() && (keys_[at] >> bucket_bits_) < bucket) ++at;
    first_in_bucket_.push_back(static_cast<std::int32_t>(at));
  }
}

std::vector<CellGrid::Cell> CellGrid::OccupiedCells(const IsCancelled& is_cancelled) const {
  CancellationPoll poll(is_cancelled);
  std::vector<Cell> out;
  out.reserve(std::min(order_.size(), start_.size()));
  Eigen::Vector3i at = Eigen::Vector3i::Zero();
  std::uint64_t row_begin = 0;  // the key of the row's first cell
  const std::uint64_t row = static_cast<std::uint64_t>(last_.x()) + 1;
  for (std::size_t cell = 0; cell + 1 < start_.size(); ++cell) {
    if (poll.AfterPoints()) return {};
    if (start_[cell] == start_[cell + 1]) continue;
    const std::uint64_t key = keys_.empty() ? cell : keys_[cell];
    if (key - row_begin >= row) {
      row_begin = key / row * row;
      at.y() = static_cast<int>(key / row % (static_cast<std::uint64_t>(last_.y()) + 1));
      at.z() = static_cast<int>(key / row / (static_cast<std::uint64_t>(last_.y()) + 1));
    }
    at.x() = static_cast<int>(key - row_begin);
    out.push_back({at, start_[cell], start_[cell + 1]});
  }
  return out;
}

void CellGrid::Gather(const Eigen::Vector3i& at, int reach, CellBlock* out) const {
  const std::size_t count = CountAround(at, reach);
  const std::size_t padded = simd::Padded(count);
  std::array<std::vector<float>*, 3> to = {&out->x, &out->y, &out->z};
  for (auto* axis : to) {
    axis->resize(padded);
    std::fill(axis->begin() + static_cast<std::ptrdiff_t>(count), axis->end(), simd::kFar);
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
