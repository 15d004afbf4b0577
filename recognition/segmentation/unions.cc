#include "recognition/segmentation/unions.h"

#include <algorithm>
#include <tuple>

#include "recognition/base/bounds.h"

namespace graspdb::recognition {
namespace {

template <typename T>
void Append(const std::vector<T>& from, std::vector<T>* to) {
  to->insert(to->end(), from.begin(), from.end());
}

}  // namespace

std::vector<SegmentPair> NeighbouringPairs(std::span<const Segment* const> segments,
                                           double max_gap_m, double max_size_m) {
  std::vector<Eigen::AlignedBox3f> boxes;
  boxes.reserve(segments.size());
  for (const Segment* segment : segments) boxes.push_back(BoundsOf(segment->cloud.points));
  std::vector<std::tuple<float, std::size_t, std::size_t>> found;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      const float gap = boxes[i].exteriorDistance(boxes[j]);
      const float size = boxes[i].merged(boxes[j]).sizes().maxCoeff();
      if (static_cast<double>(gap) <= max_gap_m && static_cast<double>(size) <= max_size_m) {
        found.emplace_back(gap, i, j);
      }
    }
  }
  std::ranges::sort(found);
  std::vector<SegmentPair> out;
  out.reserve(found.size());
  for (const auto& [gap, i, j] : found) out.emplace_back(i, j);
  return out;
}

Segment UnionOf(const Segment& a, const Segment& b) {
  Segment out = a;
  Append(b.indices, &out.indices);
  Append(b.cloud.points, &out.cloud.points);
  Append(b.cloud.normals, &out.cloud.normals);
  out.centroid = Centroid(out.cloud.points);
  return out;
}

}  // namespace graspdb::recognition
