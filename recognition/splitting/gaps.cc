#include "recognition/splitting/gaps.h"

#include <algorithm>
#include <utility>

#include "recognition/points/nearest_grid.h"
#include "recognition/segmentation/clusters.h"
#include "recognition/segmentation/segment_part.h"

namespace graspdb::recognition {
namespace {

// Minimum width of a gap, m, and in voxels. On frames of a RealSense objects 10 mm apart are joined
// by its smoothing from 10 mm on; half of it would split surfaces at holes.
constexpr double kGapM = 0.008;
constexpr double kGapVoxels = 2.7;
// Voxels lower than this over the removed table connect nothing, m: twice the bumps of a RealSense
// at 0.8 m. Doubled, flat objects have no voxels left.
constexpr double kLowM = 0.004;
// Low voxels go with a part that is no farther than this, m; those farther away belong to the
// table.
constexpr float kReachM = 0.008F;
// Cells of the look-up of the nearest part, m: the result may be 5 mm farther than the nearest
// voxel, which is less than the gap between parts.
constexpr float kCellM = 0.003F;

}  // namespace

std::vector<Segment> SplitAtGaps(const MatchingInput& input, double voxel_size_m,
                                 std::size_t min_count, const IsCancelled& is_cancelled) {
  const Segmentation& seen = input.segmentation;
  Points high;
  for (const Eigen::Vector3f& p : input.segment.cloud.points) {
    if (!seen.table || seen.table->Height(p.cast<double>()) > seen.table_reach_m + kLowM) {
      high.push_back(p);
    }
  }
  const double gap = std::max(kGapM, kGapVoxels * voxel_size_m);
  const std::vector<Indices> clusters = FindClusters(high, gap, min_count, is_cancelled);
  if (clusters.empty() || (is_cancelled && is_cancelled())) return {};
  Points seeds;
  std::vector<int> part_of;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    for (const std::int32_t i : clusters[c]) {
      seeds.push_back(high[static_cast<std::size_t>(i)]);
      part_of.push_back(static_cast<int>(c));
    }
  }
  const NearestGrid near(seeds, kCellM, kReachM, is_cancelled);
  const PartNumber number = [&](const Eigen::Vector3f& p) {
    const int seed = near.Nearest(p);
    if (seed < 0) return -1;
    const auto i = static_cast<std::size_t>(seed);
    return (p - seeds[i]).squaredNorm() < kReachM * kReachM ? part_of[i] : -1;
  };
  std::vector<Segment> parts =
      PartsOf(input.scan, seen, input.segment, clusters.size(), number, is_cancelled);
  std::size_t kept = 0;
  for (const Segment& part : parts) kept += part.cloud.points.size();
  const bool is_split = parts.size() > 1 || kept + min_count <= input.segment.cloud.points.size();
  return is_split ? std::move(parts) : std::vector<Segment>();
}

}  // namespace graspdb::recognition
