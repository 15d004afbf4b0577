#include "recognition/points/voxels.h"

#include <array>
#include <set>
#include <vector>

#include "recognition/base/bounds.h"
#include "recognition/base/grow.h"
#include "recognition/base/round_down.h"
#include "recognition/points/keyed_points.h"

namespace graspdb::recognition {
namespace {

using Coordinates = Eigen::Array<std::int64_t, 3, 1>;

Coordinates VoxelOf(const Eigen::Vector3f& p, double inverse_size) {
  const Eigen::Vector3d at = p.cast<double>() * inverse_size;
  return Coordinates(RoundDown(at.x()), RoundDown(at.y()), RoundDown(at.z()));
}

}  // namespace

VoxelCloud DownsampleToVoxels(const Points& points, double voxel_size_m,
                              const IsCancelled& is_cancelled) {
  VoxelCloud out;
  if (points.empty()) return out;
  const double inverse_size = 1 / voxel_size_m;
  // The order of coordinates is that of voxels.
  const Eigen::AlignedBox3f bounds = BoundsOf(points);
  const Coordinates first = VoxelOf(bounds.min(), inverse_size);
  const Coordinates size = VoxelOf(bounds.max(), inverse_size) - first + 1;
  CancellationPoll poll(is_cancelled);
  std::vector<KeyedPoint> order;
  if (!GrowTo(points.size(), &poll, &order)) return out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (poll.AfterPoints()) return out;
    const Coordinates c = VoxelOf(points[i], inverse_size) - first;
    order[i] = {static_cast<std::uint64_t>((c.z() * size.y() + c.y()) * size.x() + c.x()),
                static_cast<std::int32_t>(i)};
  }
  SortByKey(static_cast<std::uint64_t>(size.prod() - 1), &order, is_cancelled);

  if (!GrowTo(points.size(), &poll, &out.voxel_of)) return {};
  out.points.reserve(points.size());
  for (std::size_t begin = 0; begin < order.size();) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t end = begin;
    for (; end < order.size() && order[end].key == order[begin].key; ++end) {
      const auto point = static_cast<std::size_t>(order[end].point);
      sum += points[point].cast<double>();
      out.voxel_of[point] = static_cast<std::int32_t>(out.points.size());
      if (poll.AfterPoints()) return {};
    }
    out.points.push_back((sum / static_cast<double>(end - begin)).cast<float>());
    begin = end;
  }
  return out;
}

bool HasVoxels(const Points& points, double voxel_size_m, std::size_t count) {
  const double inverse_size = 1 / voxel_size_m;
  std::set<std::array<std::int64_t, 3>> found;
  for (auto p = points.begin(); found.size() < count && p != points.end(); ++p) {
    const Coordinates c = VoxelOf(*p, inverse_size);
    found.insert(std::array<std::int64_t, 3>{c.x(), c.y(), c.z()});
  }
  return found.size() >= count;
}

}  // namespace graspdb::recognition
