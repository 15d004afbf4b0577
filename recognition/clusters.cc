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

// Joins the cells of which points come within the tolerance. Returns for each point its cell.
std::vector<std::size_t> JoinCells(const Points& points, const CellGrid& grid, float tolerance_m,
                                   DisjointSets* sets) {
  const std::vector<CellGrid::Cell> cells = grid.OccupiedCells();
  const std::span order(grid.order());
  const auto points_of = [&](const CellGrid::Cell& cell) {
    return order.subspan(static_cast<std::size_t>(cell.begin),
                         static_cast<std::size_t>(cell.end - cell.begin));
  };
  // By position in the order, since ranges are.
  std::vector<std::size_t> cell_at(order.size());
  std::vector<std::size_t> cell_of(order.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::int32_t i = cells[c].begin; i < cells[c].end; ++i) {
      cell_at[static_cast<std::size_t>(i)] = c;
      cell_of[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = c;
    }
  }
  for (std::size_t c = 0; c < cells.size(); ++c) {
    grid.ForEachRange(cells[c].at, kReach, [&](std::int32_t begin, std::int32_t end) {
      while (begin < end) {
        const std::size_t other = cell_at[static_cast<std::size_t>(begin)];
        begin = cells[other].end;
        // Every pair is seen from both.
        if (other <= c || sets->Find(other) == sets->Find(c)) continue;
        if (ComeWithin(points, points_of(cells[c]), points_of(cells[other]),
                       tolerance_m * tolerance_m)) {
          sets->Join(c, other);
        }
      }
    });
  }
  return cell_of;
}

// The same point by point, where cells are too large to tell. Returns each point itself.
std::vector<std::size_t> JoinPoints(const Points& points, const CellGrid& grid, float tolerance_m,
                                    DisjointSets* sets) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    grid.ForEachRange(grid.CellOf(points[i]), kReach, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t at = begin; at < end; ++at) {
        const auto j = static_cast<std::size_t>(grid.order()[static_cast<std::size_t>(at)]);
        if ((points[i] - points[j]).squaredNorm() <= tolerance_m * tolerance_m) sets->Join(i, j);
      }
    });
  }
  std::vector<std::size_t> out(points.size());
  std::iota(out.begin(), out.end(), 0);
  return out;
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
    grid.ForEachRange(grid.CellOf(p), reach, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t at = begin; at < end; ++at) {
        const auto j = static_cast<std::size_t>(grid.order()[static_cast<std::size_t>(at)]);
        const int other = cluster_of[j];
        if (other < 0 || other == own) continue;
        const float distance = (p - points[j]).squaredNorm();
        if (distance > best || (distance == best && nearest >= 0)) continue;
        best = distance;
        nearest = other;
      }
    });
  }
  return nearest;
}

}  // namespace

std::vector<Indices> FindClusters(const Points& points, double tolerance_m, std::size_t min_count) {
  if (points.empty()) return {};
  const auto cell_m = static_cast<float>(kCellShare * tolerance_m);
  const CellGrid grid(points, cell_m);
  DisjointSets sets(points.size());
  const auto join = grid.cell_m() > cell_m ? JoinPoints : JoinCells;
  const std::vector<std::size_t> set_of =
      join(points, grid, static_cast<float>(tolerance_m), &sets);
  std::vector<Indices> clusters;
  constexpr auto kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> number(points.size(), kNone);  // of the cluster of a set
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t& cluster = number[sets.Find(set_of[i])];
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
