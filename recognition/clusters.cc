#include "recognition/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "recognition/cell_grid.h"

namespace graspdb::recognition {
namespace {

// Cells of this share of the tolerance are so small that any two points in one are within it.
constexpr double kCellShare = 0.577;
// Cells within the tolerance of each other are at most so many apart along an axis.
constexpr int kReach = 2;

// Sets that are joined with each other (R. E. Tarjan, 1975).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::size_t Find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Join(std::size_t a, std::size_t b) { parent_[Find(a)] = Find(b); }

 private:
  std::vector<std::size_t> parent_;
};

bool ComeWithin(const Points& points, std::span<const std::int32_t> a,
                std::span<const std::int32_t> b, float squared_tolerance) {
  for (const std::int32_t i : a) {
    const Eigen::Vector3f& p = points[static_cast<std::size_t>(i)];
    for (const std::int32_t j : b) {
      if ((p - points[static_cast<std::size_t>(j)]).squaredNorm() <= squared_tolerance) return true;
    }
  }
  return false;
}

// Points of which each is within the tolerance of the others: those of a small cell; where cells
// had to be larger, every point alone. In the order of the grid.
std::vector<CellGrid::Cell> CloseGroups(const CellGrid& grid, bool cells_are_small) {
  std::vector<CellGrid::Cell> cells = grid.OccupiedCells();
  if (cells_are_small) return cells;
  std::vector<CellGrid::Cell> singles;
  singles.reserve(grid.order().size());
  for (const CellGrid::Cell& cell : cells) {
    for (std::int32_t i = cell.begin; i < cell.end; ++i) singles.push_back({cell.at, i, i + 1});
  }
  return singles;
}

// The sets of points that steps of at most the tolerance lead between.
DisjointSets JoinNeighbours(const Points& points, const CellGrid& grid,
                            const std::vector<CellGrid::Cell>& groups, float squared_tolerance) {
  const std::span order(grid.order());
  DisjointSets sets(points.size());
  const auto first = [&](std::int32_t at) {
    return static_cast<std::size_t>(order[static_cast<std::size_t>(at)]);
  };
  const auto members = [&](std::int32_t begin, std::int32_t end) {
    return order.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  };
  std::vector<std::int32_t> end_of(order.size());  // of the group that begins there
  for (const CellGrid::Cell& group : groups) {
    end_of[static_cast<std::size_t>(group.begin)] = group.end;
    for (std::int32_t i = group.begin + 1; i < group.end; ++i) {
      sets.Join(first(i), first(group.begin));
    }
  }
  for (const CellGrid::Cell& group : groups) {
    grid.ForEachRange(group.at, kReach, [&](std::int32_t begin, std::int32_t end) {
      // Those before were compared with this one already.
      for (begin = std::max(begin, group.end); begin < end;) {
        const std::int32_t next = end_of[static_cast<std::size_t>(begin)];
        if (sets.Find(first(begin)) != sets.Find(first(group.begin)) &&
            ComeWithin(points, members(group.begin, group.end), members(begin, next),
                       squared_tolerance)) {
          sets.Join(first(begin), first(group.begin));
        }
        begin = next;
      }
    });
  }
  return sets;
}

// The cluster other than the points' own that comes nearest to them, -1 when none
// comes within `max_gap_m`.
int NearestCluster(const Points& points, const CellGrid& grid, const Indices& cluster,
                   const std::vector<int>& cluster_of, double max_gap_m) {
  const int own = cluster_of[static_cast<std::size_t>(cluster.front())];
  int nearest = -1;
  auto best = static_cast<float>(max_gap_m * max_gap_m);
  const int reach = static_cast<int>(std::ceil(max_gap_m / static_cast<double>(grid.cell_m())));
  for (const std::int32_t i : cluster) {
    const Eigen::Vector3f& p = points[static_cast<std::size_t>(i)];
    grid.ForEachPoint(p, reach, [&](std::size_t j) {
      const int other = cluster_of[j];
      if (other < 0 || other == own) return;
      const float distance = (p - points[j]).squaredNorm();
      if (distance > best || (distance == best && nearest >= 0)) return;
      best = distance;
      nearest = other;
    });
  }
  return nearest;
}

}  // namespace

std::vector<Indices> FindClusters(const Points& points, double tolerance_m, std::size_t min_count) {
  if (points.empty()) return {};
  const auto cell_m = static_cast<float>(kCellShare * tolerance_m);
  const CellGrid grid(points, cell_m);
  const auto tolerance = static_cast<float>(tolerance_m);
  DisjointSets sets = JoinNeighbours(points, grid, CloseGroups(grid, grid.cell_m() <= cell_m),
                                     tolerance * tolerance);
  std::vector<Indices> clusters;
  constexpr auto kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> number(points.size(), kNone);  // of the cluster of a set
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t& cluster = number[sets.Find(i)];
    if (cluster == kNone) {
      cluster = clusters.size();
      clusters.emplace_back();
    }
    clusters[cluster].push_back(static_cast<std::int32_t>(i));
  }
  std::erase_if(clusters, [&](const Indices& cluster) { return cluster.size() < min_count; });
  return clusters;
}

std::vector<Indices> JoinUnsupported(const Points& points, const std::vector<double>& heights,
                                     std::vector<Indices> clusters, double max_gap_m) {
  if (clusters.size() < 2) return clusters;
  const CellGrid grid(points, static_cast<float>(max_gap_m));
  std::vector<int> cluster_of(points.size(), -1);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    for (const std::int32_t i : clusters[c]) {
      cluster_of[static_cast<std::size_t>(i)] = static_cast<int>(c);
    }
  }
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const auto height = [&](std::int32_t i) { return heights[static_cast<std::size_t>(i)]; };
    const auto lowest = std::ranges::min_element(clusters[c], {}, height);
    if (height(*lowest) <= max_gap_m) continue;
    const int support = NearestCluster(points, grid, clusters[c], cluster_of, max_gap_m);
    if (support < 0) continue;
    Indices& joined = clusters[static_cast<std::size_t>(support)];
    for (const std::int32_t i : clusters[c]) cluster_of[static_cast<std::size_t>(i)] = support;
    joined.insert(joined.end(), clusters[c].begin(), clusters[c].end());
    std::sort(joined.begin(), joined.end());
    clusters[c].clear();
  }
  std::erase_if(clusters, [](const Indices& cluster) { return cluster.empty(); });
  return clusters;
}

}  // namespace graspdb::recognition
