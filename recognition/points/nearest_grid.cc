#include "recognition/points/nearest_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "recognition/base/bounds.h"
#include "recognition/simd/kernels.h"

namespace graspdb::recognition {
namespace {

// Blocks of 512 bytes, 32 MB: enough for 1 m^2 of surface in voxels of 3 mm six times over.
constexpr std::int32_t kMaxBlocks = 65536;
// Places in the table of blocks, 4 MB: enough for a cube of 1.5 m in cells of 3 mm.
constexpr double kMaxBlockTable = 1 << 20;
constexpr int kMaxBlocksCellsPerAxis = 1 << 20;

// Maximum number of cells between a point's and one whose centre is within reach.
int LayersWithin(float reach_m, float cell_m) {
  return static_cast<int>(std::ceil((reach_m + std::sqrt(0.75F) * cell_m) / cell_m));
}

// The block of a cell, along x, y and z.
Eigen::Array3i BlockAt(const Eigen::Array3i& cell) {
  return {cell.x() >> simd::kBlockXBits, cell.y() >> simd::kBlockYzBits,
          cell.z() >> simd::kBlockYzBits};
}

// The rows of cells of which some are at most `reach` cells away from a point in the middle one.
std::vector<simd::BallRow> RowsWithin(float reach) {
  std::vector<simd::BallRow> out;
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

NearestGrid::Level::Level(const Points& points, float cell_m, float reach_m,
                          const IsCancelled& is_cancelled)
    : inverse_cell_(1 / cell_m), cells_(simd::kBlockCells, -1) {
  if (points.empty()) return;
  CancellationPoll poll(is_cancelled);
  while (!Allocate(points, cell_m, reach_m, poll)) cell_m *= 2;
  if (poll.Now()) return;
  const float far = reach_m + std::sqrt(0.75F) * cell_m;
  std::vector<float> best(cells_.size(), far * far);
  const std::vector<simd::BallRow> rows = RowsWithin(far * inverse_cell_);
  const simd::Cells all = {table(), cell_m, best.data(), cells_.data()};
  for (const std::int32_t i : OneEachCell(points, poll)) {
    if (poll.AfterPoints()) return;
    const Eigen::Array3f at = Place(points[static_cast<std::size_t>(i)]);
    simd::Best().spread(rows.data(), rows.size(), at.data(), i, all);
  }
}

bool NearestGrid::Level::Allocate(const Points& points, float cell_m, float reach_m,
                                  CancellationPoll& poll) {
  inverse_cell_ = 1 / cell_m;
  const Eigen::AlignedBox3f bounds = BoundsOf(points);
  const Eigen::Vector3f cells = bounds.sizes() * inverse_cell_;
  const int reach = LayersWithin(reach_m, cell_m);
  const int margin = reach + 1;  // rounding may put a point into the cell beside its own
  // Also false where they do not fit an integer.
  if (!(cells.maxCoeff() < static_cast<float>(kMaxBlocksCellsPerAxis))) return false;
  size_ = cells.array().floor().cast<int>() + 2 * margin + 1;
  block_count_.x() = (size_.x() >> simd::kBlockXBits) + 1;
  block_count_.tail<2>() = (size_.tail<2>().array() / (1 << simd::kBlockYzBits)) + 1;
  if (block_count_.cast<double>().prod() > kMaxBlockTable) return false;
  origin_ = bounds.min().array() - static_cast<float>(margin) * cell_m;
  blocks_.assign(static_cast<std::size_t>(block_count_.prod()), 0);
  std::int32_t count = 1;  // the first one is empty
  Eigen::Array3i last_low = Eigen::Array3i::Constant(-1);
  Eigen::Array3i last_high = last_low;
  const auto row = static_cast<std::ptrdiff_t>(block_count_.x());
  const std::ptrdiff_t layer = row * block_count_.y();
  for (const Eigen::Vector3f& p : points) {
    if (poll.AfterPoints()) {
      std::ranges::fill(blocks_, 0);
      return true;
    }
    const Eigen::Array3i at = Place(p).cast<int>();
    const Eigen::Array3i low = BlockAt((at - reach).max(0));
    const Eigen::Array3i high = BlockAt((at + reach).min(size_.array() - 1));
    // Neighbours mostly meet the same blocks.
    if ((low == last_low).all() && (high == last_high).all()) continue;
    last_low = low;
    last_high = high;
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          std::int32_t& begin = blocks_[static_cast<std::size_t>(z * layer + y * row + x)];
          if (begin == 0) begin = simd::kBlockCells * count++;
        }
      }
    }
    if (count > kMaxBlocks) return false;
  }
  cells_.assign(static_cast<std::size_t>(count) * simd::kBlockCells, -1);
  return true;
}

// Of the points in one cell the nearest to its centre stands for all of them. Uses the cells, and
// leaves them empty.
Indices NearestGrid::Level::OneEachCell(const Points& points, CancellationPoll& poll) {
  Indices occupied;
  const auto place = [&](std::int32_t i) { return Place(points[static_cast<std::size_t>(i)]); };
  const auto off = [](const Eigen::Array3f& at) {
    return (at - at.floor() - 0.5F).matrix().squaredNorm();
  };
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(points.size()); ++i) {
    if (poll.AfterPoints()) break;
    const Eigen::Array3f at = place(i);
    const std::size_t cell = CellOf(at);
    std::int32_t& known = cells_[cell];
    if (known < 0) occupied.push_back(static_cast<std::int32_t>(cell));
    if (known < 0 || off(at) < off(place(known))) known = i;
  }
  for (std::int32_t& cell : occupied) {
    cell = std::exchange(cells_[static_cast<std::size_t>(cell)], -1);
  }
  return occupied;
}

simd::NearestCells NearestGrid::Level::cells() const {
  simd::NearestCells out;
  out.nearest = cells_.data();
  out.blocks = table();
  Eigen::Map<Eigen::Vector3f>(out.origin) = origin_;
  out.inverse_cell = inverse_cell_;
  Eigen::Map<Eigen::Vector3f>(out.size) = size_.cast<float>();
  return out;
}

NearestGrid::NearestGrid(const Points& points, float cell_m, float reach_m,
                         const IsCancelled& is_cancelled)
    : near_(points, cell_m, 2 * cell_m, is_cancelled),
      far_(points, 2 * cell_m, reach_m, is_cancelled) {}

simd::LookUp NearestGrid::LookUpIn(const OrientedCloud& cloud) const {
  return {.near = near_.cells(),
          .far = far_.cells(),
          .points = cloud.points.empty() ? nullptr : cloud.points.front().data(),
          .normals = cloud.normals.empty() ? nullptr : cloud.normals.front().data()};
}

}  // namespace graspdb::recognition
