#include "recognition/splitting/halves.h"

#include <algorithm>
#include <array>

#include "recognition/segmentation/segment_part.h"

namespace graspdb::recognition {
namespace {

// Iterations of k-means for two halves.
constexpr int kHalvingSteps = 8;

// Two points over the table, one in the middle of either half (k-means, from the ends).
std::array<Eigen::Vector2f, 2> MiddlesOfHalves(const Points& points) {
  std::array<Eigen::Vector2f, 2> middles = {points.front().head<2>(), points.front().head<2>()};
  // The point farthest from any is one end, the farthest from that the other.
  for (const int end : {0, 1, 0}) {
    const Eigen::Vector2f from = middles[static_cast<std::size_t>(1 - end)];
    middles[static_cast<std::size_t>(end)] =
        std::ranges::max_element(points, {}, [&](const Eigen::Vector3f& p) {
          return (p.head<2>() - from).squaredNorm();
        })->head<2>();
  }
  for (int step = 0; step < kHalvingSteps; ++step) {
    std::array<Eigen::Vector2f, 2> sums = {Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero()};
    std::array<float, 2> counts = {};
    for (const Eigen::Vector3f& p : points) {
      const std::size_t half =
          (p.head<2>() - middles[1]).squaredNorm() < (p.head<2>() - middles[0]).squaredNorm();
      sums[half] += p.head<2>();
      ++counts[half];
    }
    for (const std::size_t half : {0U, 1U}) {
      if (counts[half] > 0) middles[half] = sums[half] / counts[half];
    }
  }
  return middles;
}

}  // namespace

std::vector<Segment> SplitInHalves(const MatchingInput& input, const IsCancelled& is_cancelled) {
  const auto middles = MiddlesOfHalves(input.segment.cloud.points);
  const PartNumber nearer = [&](const Eigen::Vector3f& p) {
    return (p.head<2>() - middles[1]).squaredNorm() < (p.head<2>() - middles[0]).squaredNorm();
  };
  return PartsOf(input.scan, input.segmentation, input.segment, 2, nearer, is_cancelled);
}

}  // namespace graspdb::recognition
