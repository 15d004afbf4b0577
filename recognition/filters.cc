#include "recognition/filters.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace graspdb::recognition {
namespace {

// Coordinates of a voxel, the last one first: sorting gives the order z, y, x.
using VoxelKey = std::array<std::int32_t, 3>;

VoxelKey KeyOf(const Eigen::Vector3f& p, double inverse_size) {
  const auto cell = [&](float x) {
    return static_cast<std::int32_t>(std::floor(static_cast<double>(x) * inverse_size));
  };
  return {cell(p.z()), cell(p.y()), cell(p.x())};
}

// The direction of least spread of the neighbours about their mean.
Eigen::Vector3d LeastSpread(const Points& points, const std::vector<Neighbor>& neighbors) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Neighbor& n : neighbors) {
    mean += points[static_cast<std::size_t>(n.index)].cast<double>();
  }
  mean /= static_cast<double>(neighbors.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Neighbor& n : neighbors) {
    const Eigen::Vector3d d = points[static_cast<std::size_t>(n.index)].cast<double>() - mean;
    covariance += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  return solver.eigenvectors().col(0);
}

}  // namespace

Indices RemoveStatisticalOutliers(const Points& points, int neighbor_count,
                                  double deviation_factor) {
  Indices kept(points.size());
  std::iota(kept.begin(), kept.end(), 0);
  if (neighbor_count <= 0 || points.size() <= static_cast<std::size_t>(neighbor_count)) return kept;

  const PointSearch search(points);
  std::vector<double> mean_distance(points.size());
  std::vector<Neighbor> neighbors;
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    search.Nearest(points[i], neighbor_count + 1, &neighbors);  // the point itself is one of them
    double total = 0;
    for (const Neighbor& n : neighbors) total += std::sqrt(static_cast<double>(n.squared_distance));
    mean_distance[i] = total / neighbor_count;
    sum += mean_distance[i];
    squares += mean_distance[i] * mean_distance[i];
  }
  const auto count = static_cast<double>(points.size());
  const double variance = std::max(0.0, (squares - sum * sum / count) / (count - 1));
  const double limit = sum / count + deviation_factor * std::sqrt(variance);
  std::erase_if(kept,
                [&](std::int32_t i) { return mean_distance[static_cast<std::size_t>(i)] > limit; });
  return kept;
}

VoxelCloud DownsampleToVoxels(const Points& points, double voxel_size_m) {
  std::vector<std::pair<VoxelKey, std::int32_t>> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    order[i] = {KeyOf(points[i], 1 / voxel_size_m), static_cast<std::int32_t>(i)};
  }
  std::sort(order.begin(), order.end());

  VoxelCloud out;
  out.voxel_of.resize(points.size());
  for (std::size_t begin = 0; begin < order.size();) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t end = begin;
    for (; end < order.size() && order[end].first == order[begin].first; ++end) {
      const auto point = static_cast<std::size_t>(order[end].second);
      sum += points[point].cast<double>();
      out.voxel_of[point] = static_cast<std::int32_t>(out.points.size());
    }
    out.points.push_back((sum / static_cast<double>(end - begin)).cast<float>());
    begin = end;
  }
  return out;
}

Normals EstimateNormals(const Points& points, const PointSearch& search,
                        const Eigen::Vector3d& viewpoint, double radius_m) {
  Normals normals(points.size());
  std::vector<Neighbor> neighbors;
  for (std::size_t i = 0; i < points.size(); ++i) {
    search.Within(points[i], static_cast<float>(radius_m), &neighbors);
    const Eigen::Vector3d to_viewpoint = viewpoint - points[i].cast<double>();
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    if (!to_viewpoint.isZero()) normal = to_viewpoint.normalized();
    if (neighbors.size() >= 3) {
      normal = LeastSpread(points, neighbors);
      if (normal.dot(to_viewpoint) < 0) normal = -normal;
    }
    normals[i] = normal.cast<float>();
  }
  return normals;
}

}  // namespace graspdb::recognition
