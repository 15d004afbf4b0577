#include "recognition/matching/reachable_share.h"

#include <algorithm>
#include <cmath>

#include "recognition/base/bounds.h"

namespace graspdb::recognition {

ReachableShare::ReachableShare(const Points& points, std::size_t stride) {
  if (points.empty()) return;
  const Eigen::AlignedBox3f bounds = BoundsOf(points);
  cell_m_ = std::max(bounds.sizes().head<2>().maxCoeff() / (kCells - 0.5F), 1e-6F);
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Eigen::Vector2f at = (points[i] - bounds.min()).head<2>() / cell_m_;
    ++sums_(static_cast<int>(at.x()) + 1, static_cast<int>(at.y()) + 1);
    heights_.push_back(points[i].z());
  }
  std::ranges::sort(heights_);
  for (int y = 1; y <= kCells; ++y) {
    for (int x = 1; x <= kCells; ++x) {
      sums_(x, y) += sums_(x - 1, y) + sums_(x, y - 1) - sums_(x - 1, y - 1);
    }
  }
}

double ReachableShare::Within(float radius_m) const {
  if (heights_.empty()) return 1;
  // An interval of n cells overlaps one cell more.
  const float width = std::min(std::floor(2 * radius_m / cell_m_), static_cast<float>(kCells));
  const int cells = std::min(kCells, static_cast<int>(width) + 2);
  int max_count = 0;
  for (int y = cells; y <= kCells; ++y) {
    for (int x = cells; x <= kCells; ++x) {
      max_count = std::max(max_count, sums_(x, y) - sums_(x - cells, y) - sums_(x, y - cells) +
                                          sums_(x - cells, y - cells));
    }
  }
  return static_cast<double>(max_count) / static_cast<double>(heights_.size());
}

double ReachableShare::NotHigher(float z_m) const {
  if (heights_.empty()) return 1;
  const auto higher = std::ranges::upper_bound(heights_, z_m);
  return static_cast<double>(higher - heights_.begin()) / static_cast<double>(heights_.size());
}

}  // namespace graspdb::recognition
