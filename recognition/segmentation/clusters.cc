#include "recognition/segmentation/clusters.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>

#include "recognition/base/grow.h"
#include "recognition/points/cell_grid.h"

namespace graspdb::recognition {
namespace {

// Cells of this share of the tolerance are so small that any two points in one are within it.
constexpr double kCellShare = 0.577;
// Maximum distance along an axis of cells within the tolerance of each other, in cells.
constexpr int kReach = 2;
constexpr std::size_t kCellsAround = 125;  // within kReach
// Distances that joining computes in all, about 1 s; a frame of a million voxels takes a tenth.
constexpr std::size_t kMaxJoinWork = 1'000'000'000;

// Sets that are joined with each other (R. E. Tarjan, 1975).
class DisjointSets {
 public:
  DisjointSets(std::size_t count, CancellationPoll* poll) {
    GrowTo(count, poll, &parent_);
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
                std::span<const std::int32_t> b, float squared_tolerance, CancellationPoll& poll) {
  for (const std::int32_t i : a) {
    if (poll.AfterDistances(b.size())) return false;
    const Eigen::Vector3f& p = points[static_cast<std::size_t>(i)];
    for (const std::int32_t j : b) {
      if ((p - points[static_cast<std::size_t>(j)]).squaredNorm() <= squared_tolerance) return true;
    }
  }
  return false;
}

// The sets of points connected by steps of at most the tolerance.
DisjointSets JoinNeighbours(const Points& points, const CellGrid& grid, float squared_tolerance,
                            const IsCancelled& is_cancelled, CancellationPoll& poll) {
  const std::vector<CellGrid::Cell> groups = grid.OccupiedCells(is_cancelled);
  const std::span order(grid.order());
  DisjointSets sets(points.size(), &poll);
  const auto first = [&](std::int32_t at) {
    return static_cast<std::size_t>(order[static_cast<std::size_t>(at)]);
  };
  const auto members = [&](std::int32_t begin, std::int32_t end) {
    return order.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  };
  std::vector<std::int32_t> end_of;  // of the group that begins there
  if (!GrowTo(order.size(), &poll, &end_of)) return sets;
  for (const CellGrid::Cell& group : groups) {
    if (poll.AfterPoints(static_cast<std::size_t>(group.end - group.begin))) break;
    end_of[static_cast<std::size_t>(group.begin)] = group.end;
    for (std::int32_t i = group.begin + 1; i < group.end; ++i) {
      sets.Join(first(i), first(group.begin));
    }
  }
  for (const CellGrid::Cell& group : groups) {
    if (poll.AfterPoints(kCellsAround)) break;
    grid.ForEachRange(group.at, kReach, [&](std::int32_t begin, std::int32_t end) {
      // Those before were compared with this one already.
      for (begin = std::max(begin, group.end); begin < end;) {
        const std::int32_t next = end_of[static_cast<std::size_t>(begin)];
        if (sets.Find(first(begin)) != sets.Find(first(group.begin)) &&
            ComeWithin(points, members(group.begin, group.end), members(begin, next),
                       squared_tolerance, poll)) {
          sets.Join(first(begin), first(group.begin));
        }
        begin = next;
      }
    });
  }
  return sets;
}

// Finds the cluster that supports another one.
class SupportSearch {
 public:
  SupportSearch(const Points& points, const std::vector<Indices>& clusters, double max_gap_m,
                const IsCancelled& is_cancelled)
      : points_(points),
        max_gap_m_(static_cast<float>(max_gap_m)),
        grid_(points, max_gap_m_, is_cancelled),
        cluster_of_(points.size(), -1),
        poll_(is_cancelled) {
    for (std::size_t c = 0; c < clusters.size(); ++c) SetCluster(clusters[c], static_cast<int>(c));
  }

  void SetCluster(const Indices& points, int cluster) {
    for (const std::int32_t i : points) cluster_of_[static_cast<std::size_t>(i)] = cluster;
  }

  // The cluster other than the points' own that comes nearest to them, -1 when none comes within
  // the gap, or when all work is spent.
  int NearestTo(const Indices& cluster) {
    const int own = cluster_of_[static_cast<std::size_t>(cluster.front())];
    int nearest = -1;
    float best = max_gap_m_ * max_gap_m_;
    for (const std::int32_t i : cluster) {
      const Eigen::Vector3f& p = points_[static_cast<std::size_t>(i)];
      std::size_t looked_at = 0;
      grid_.ForEachPoint(p, 1, [&](std::size_t j) {
        ++looked_at;
        const int other = cluster_of_[j];
        if (other < 0 || other == own) return;
        const float distance = (p - points_[j]).squaredNorm();
        if (distance > best || (distance == best && nearest >= 0)) return;
        best = distance;
        nearest = other;
      });
      work_ += looked_at;
      if (work_ > kMaxJoinWork || poll_.AfterDistances(looked_at)) return -1;
    }
    return nearest;
  }

 private:
  const Points& points_;
  const float max_gap_m_;
  const CellGrid grid_;
  std::vector<int> cluster_of_;
  CancellationPoll poll_;
  std::size_t work_ = 0;
};

}  // namespace

std::vector<Indices> FindClusters(const Points& points, double tolerance_m, std::size_t min_count,
                                  const IsCancelled& is_cancelled) {
  if (points.empty()) return {};
  const CellGrid grid(points, static_cast<float>(kCellShare * tolerance_m), is_cancelled);
  const auto tolerance = static_cast<float>(tolerance_m);
  CancellationPoll poll(is_cancelled);
  DisjointSets sets = JoinNeighbours(points, grid, tolerance * tolerance, is_cancelled, poll);
  std::vector<std::size_t> count;  // of the points of a set
  if (!GrowTo(points.size(), &poll, &count)) return {};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (poll.AfterPoints()) return {};
    ++count[sets.Find(i)];
  }
  std::vector<Indices> clusters;
  constexpr auto kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> number(points.size(), kNone);  // of the cluster of a set
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (poll.AfterPoints()) return {};
    const std::size_t set = sets.Find(i);
    if (count[set] < min_count) continue;
    if (number[set] == kNone) {
      number[set] = clusters.size();
      clusters.emplace_back();
    }
    clusters[number[set]].push_back(static_cast<std::int32_t>(i));
  }
  return clusters;
}

std::vector<Indices> JoinUnsupported(const Points& points, const std::vector<double>& heights,
                                     std::vector<Indices> clusters, double max_gap_m,
                                     const IsCancelled& is_cancelled) {
  if (clusters.size() < 2) return clusters;
  SupportSearch search(points, clusters, max_gap_m, is_cancelled);
  for (Indices& cluster : clusters) {
    const auto height = [&](std::int32_t i) { return heights[static_cast<std::size_t>(i)]; };
    const auto lowest = std::ranges::min_element(cluster, {}, height);
    if (height(*lowest) <= max_gap_m) continue;
    const int support = search.NearestTo(cluster);
    if (support < 0) continue;
    search.SetCluster(cluster, support);
    Indices& joined = clusters[static_cast<std::size_t>(support)];
    joined.insert(joined.end(), cluster.begin(), cluster.end());
    cluster.clear();
  }
  std::erase_if(clusters, [](const Indices& cluster) { return cluster.empty(); });
  for (Indices& cluster : clusters) std::ranges::sort(cluster);
  return clusters;
}

}  // namespace graspdb::recognition
