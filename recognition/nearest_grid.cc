#include "recognition/nearest_grid.h"

#include <cmath>
#include <limits>

namespace graspdb::recognition {

NearestGrid::NearestGrid(const Points& points, float cell_m, float reach_m)
    : cell_m_(cell_m), inverse_cell_(1 / cell_m) {
  if (points.empty()) return;
  Eigen::Vector3f low = points.front();
  Eigen::Vector3f high = points.front();
  for (const Eigen::Vector3f& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const int layers = static_cast<int>(std::ceil(reach_m / cell_m));
  origin_ = low.array() - static_cast<float>(layers + 1) * cell_m;
  const Eigen::Vector3f cells = (high - low) * inverse_cell_;
  size_ = cells.array().floor().cast<int>() + 2 * layers + 3;
  cells_.assign(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) *
                    static_cast<std::size_t>(size_.z()),
                -1);
  Seed(points);
  Spread(points, layers);
}

void NearestGrid::Seed(const Points& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3i c = ((points[i] - origin_) * inverse_cell_).cast<int>();
    const Eigen::Vector3f center = origin_ + (c.cast<float>().array() + 0.5F).matrix() * cell_m_;
    std::int32_t& cell = cells_[Offset(c)];
    if (cell < 0 || (points[i] - center).squaredNorm() <
                        (points[static_cast<std::size_t>(cell)] - center).squaredNorm()) {
      cell = static_cast<std::int32_t>(i);
    }
  }
}

// Every layer of cells takes over what its neighbours know, if it is nearer.
void NearestGrid::Spread(const Points& points, int layers) {
  std::vector<Eigen::Vector3i> front;
  for (int z = 0; z < size_.z(); ++z) {
    for (int y = 0; y < size_.y(); ++y) {
      for (int x = 0; x < size_.x(); ++x) {
        if (cells_[Offset({x, y, z})] >= 0) front.emplace_back(x, y, z);
      }
    }
  }
  for (int layer = 0; layer < layers; ++layer) {
    std::vector<Eigen::Vector3i> next;
    for (const Eigen::Vector3i& c : front) {
      const std::int32_t known = cells_[Offset(c)];
      const Eigen::Vector3f& point = points[static_cast<std::size_t>(known)];
      for (int n = 0; n < 27; ++n) {
        const Eigen::Vector3i d(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
        const Eigen::Vector3i at = c + d;
        const Eigen::Vector3f center =
            origin_ + (at.cast<float>().array() + 0.5F).matrix() * cell_m_;
        std::int32_t& cell = cells_[Offset(at)];
        if (cell == known) continue;
        if (cell < 0 || (point - center).squaredNorm() <
                            (points[static_cast<std::size_t>(cell)] - center).squaredNorm()) {
          cell = known;
          next.push_back(at);
        }
      }
    }
    front = std::move(next);
  }
}

}  // namespace graspdb::recognition
