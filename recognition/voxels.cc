#include "recognition/voxels.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "recognition/bounds.h"

namespace graspdb::recognition {
namespace {

using Coordinates = Eigen::Array<std::int64_t, 3, 1>;

// A point and its voxel as one number, which grows with z, then y, then x.
struct Entry {
  std::uint64_t key;
  std::int32_t point;
};

// Sorts by the keys, of which the largest is `most`; equal ones stay in their order.
void RadixSort(std::uint64_t most, std::vector<Entry>* entries) {
  constexpr int kBits = 11;
  constexpr std::size_t kBuckets = std::size_t{1} << kBits;
  std::vector<Entry> other(entries->size());
  for (int shift = 0; shift < 64 && (most >> shift) > 0; shift += kBits) {
    std::array<std::uint32_t, kBuckets> begin = {};
    const auto bucket = [&](const Entry& e) { return (e.key >> shift) % kBuckets; };
    for (const Entry& e : *entries) ++begin[bucket(e)];
    std::uint32_t sum = 0;
    for (std::uint32_t& count : begin) sum += std::exchange(count, sum);
    for (const Entry& e : *entries) other[begin[bucket(e)]++] = e;
    entries->swap(other);
  }
}

Coordinates VoxelOf(const Eigen::Vector3f& p, double inverse_size) {
  return (p.cast<double>().array() * inverse_size).floor().cast<std::int64_t>();
}

}  // namespace

VoxelCloud DownsampleToVoxels(const Points& points, double voxel_size_m) {
  VoxelCloud out;
  if (points.empty()) return out;
  const double inverse_size = 1 / voxel_size_m;
  // The order of coordinates is that of voxels.
  const Eigen::AlignedBox3f bounds = BoundsOf(points);
  const Coordinates first = VoxelOf(bounds.min(), inverse_size);
  const Coordinates size = VoxelOf(bounds.max(), inverse_size) - first + 1;
  std::vector<Entry> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Coordinates c = VoxelOf(points[i], inverse_size) - first;
    order[i] = {static_cast<std::uint64_t>((c.z() * size.y() + c.y()) * size.x() + c.x()),
                static_cast<std::int32_t>(i)};
  }
  RadixSort(static_cast<std::uint64_t>(size.prod() - 1), &order);

  out.voxel_of.resize(points.size());
  out.points.reserve(points.size());
  for (std::size_t begin = 0; begin < order.size();) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t end = begin;
    for (; end < order.size() && order[end].key == order[begin].key; ++end) {
      const auto point = static_cast<std::size_t>(order[end].point);
      sum += points[point].cast<double>();
      out.voxel_of[point] = static_cast<std::int32_t>(out.points.size());
    }
    out.points.push_back((sum / static_cast<double>(end - begin)).cast<float>());
    begin = end;
  }
  return out;
}

}  // namespace graspdb::recognition
