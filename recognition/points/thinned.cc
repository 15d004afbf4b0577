#include "recognition/points/thinned.h"

#include <cstdint>
#include <unordered_map>

#include "recognition/points/cell_key.h"

namespace graspdb::recognition {
namespace {

// Sums over the points of a cell that face the same side.
struct Side {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
  float count;
  std::int32_t next;  // side of the same cell; -1: none
};

}  // namespace

OrientedCloud ThinnedToCells(const OrientedCloud& cloud, float cell_m) {
  std::unordered_map<std::uint64_t, std::int32_t> first_side;
  std::vector<Side> sides;
  std::uint64_t last_key = 0;
  std::int32_t* last = nullptr;  // neighbours are mostly in the same cell
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f& normal = cloud.normals[i];
    const std::int32_t none = -1;
    const std::uint64_t key = CellKey(cloud.points[i], cell_m);
    if (last == nullptr || key != last_key) {
      last = &first_side.try_emplace(key, none).first->second;
      last_key = key;
    }
    std::int32_t& first = *last;
    std::int32_t at = first;
    const auto faces_away = [&](const Side& side) {
      return side.normal.dot(normal) <= kSameSide * side.normal.norm();
    };
    while (at != none && faces_away(sides[static_cast<std::size_t>(at)])) {
      at = sides[static_cast<std::size_t>(at)].next;
    }
    if (at == none) {
      sides.push_back({cloud.points[i], normal, 1, first});
      first = static_cast<std::int32_t>(sides.size() - 1);
      continue;
    }
    Side& side = sides[static_cast<std::size_t>(at)];
    side.point += cloud.points[i];
    side.normal += normal;
    side.count += 1;
  }
  OrientedCloud out;
  out.points.reserve(sides.size());
  out.normals.reserve(sides.size());
  for (const Side& side : sides) {
    out.points.push_back(side.point / side.count);
    out.normals.push_back(side.normal.normalized());
  }
  return out;
}

OrientedCloud ThinnedToAtMost(std::size_t max_points, const OrientedCloud& cloud, float* step_m) {
  OrientedCloud out = ThinnedToCells(cloud, *step_m);
  while (out.points.size() > max_points) {
    const auto ratio = static_cast<float>(out.points.size()) / static_cast<float>(max_points);
    *step_m *= std::max(1.03F, std::sqrt(ratio));
    out = ThinnedToCells(cloud, *step_m);
  }
  return out;
}

}  // namespace graspdb::recognition
