#include "recognition/points/normals.h"

#include <Eigen/Eigenvalues>

#include "recognition/base/idle_cores.h"
#include "recognition/points/cell_grid.h"
#include "recognition/simd/kernels.h"

namespace graspdb::recognition {
namespace {

// Ratio of cell to radius, so that rounding does not move a neighbour two cells away.
constexpr float kRoundingMargin = 1.001F;

// Cells per job of a thread; an estimated 0.3 ms.
constexpr std::size_t kCellsAtOnce = 256;

// The direction of least spread about the mean.
Eigen::Vector3d LeastSpread(const simd::Moments& m) {
  const auto number = [](float v) { return static_cast<double>(v); };
  const Eigen::Vector3d mean =
      Eigen::Vector3d(number(m.first[0]), number(m.first[1]), number(m.first[2])) / number(m.count);
  Eigen::Matrix3d covariance;
  covariance << number(m.second[0]), number(m.second[1]), number(m.second[2]),  //
      number(m.second[1]), number(m.second[3]), number(m.second[4]),            //
      number(m.second[2]), number(m.second[4]), number(m.second[5]);
  covariance -= number(m.count) * mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  return solver.eigenvectors().col(0);
}

}  // namespace

Normals EstimateNormals(const Points& points, const Eigen::Vector3d& viewpoint, double radius_m,
                        const IsCancelled& cancelled_by_caller) {
  const IsCancelled is_cancelled = Latched(cancelled_by_caller);
  const simd::Functions& kernels = simd::Best();
  const auto radius = static_cast<float>(radius_m);
  const CellGrid grid(points, kRoundingMargin * radius, is_cancelled);
  const std::vector<CellGrid::Cell> cells = grid.OccupiedCells(is_cancelled);
  Normals normals(points.size());
  const auto estimate = [&](const CellGrid::Cell& cell, CellBlock* block) {
    for (std::int32_t i = cell.begin; i < cell.end; ++i) {
      const auto point = static_cast<std::size_t>(grid.order()[static_cast<std::size_t>(i)]);
      const simd::Moments moments =
          kernels.moments(block->coordinates(), points[point].data(), radius * radius);
      const Eigen::Vector3d to_viewpoint = viewpoint - points[point].cast<double>();
      Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
      if (moments.count >= 3) {
        normal = LeastSpread(moments);
        if (normal.dot(to_viewpoint) < 0) normal = -normal;
      } else if (!to_viewpoint.isZero()) {
        normal = to_viewpoint.normalized();
      }
      normals[point] = normal.cast<float>();
    }
  };
  const std::size_t chunks = cells.size() / kCellsAtOnce + 1;
  ForEachIndex(chunks, [&](std::size_t chunk) {
    CellBlock block;
    CancellationPoll poll(is_cancelled);
    if (poll.Now()) return;
    const std::size_t end = (chunk + 1) * cells.size() / chunks;
    for (std::size_t i = chunk * cells.size() / chunks; i < end; ++i) {
      grid.Gather(cells[i].at, 1, &block);
      const auto members = static_cast<std::size_t>(cells[i].end - cells[i].begin);
      if (poll.AfterPoints(members + 1) || poll.AfterDistances(members * block.x.size())) break;
      estimate(cells[i], &block);
    }
  });
  return normals;
}

}  // namespace graspdb::recognition
