#include "recognition/clusters.h"

#include <algorithm>
#include <limits>

namespace graspdb::recognition {
namespace {

// The cluster other than the points' own that comes nearest to them, -1 when none
// comes within `max_gap_m`.
int NearestCluster(const Points& points, const PointSearch& search, const Indices& cluster,
                   const std::vector<int>& cluster_of, double max_gap_m) {
  const int own = cluster_of[static_cast<std::size_t>(cluster.front())];
  int nearest = -1;
  float best = std::numeric_limits<float>::infinity();
  std::vector<Neighbor> neighbors;
  for (const std::int32_t i : cluster) {
    search.Within(points[static_cast<std::size_t>(i)], static_cast<float>(max_gap_m), &neighbors);
    for (const Neighbor& n : neighbors) {
      const int other = cluster_of[static_cast<std::size_t>(n.index)];
      if (other < 0 || other == own || n.squared_distance >= best) continue;
      best = n.squared_distance;
      nearest = other;
    }
  }
  return nearest;
}

}  // namespace

std::vector<Indices> FindClusters(const Points& points, const PointSearch& search,
                                  double tolerance_m, std::size_t min_count) {
  std::vector<Indices> clusters;
  std::vector<bool> taken(points.size(), false);
  std::vector<Neighbor> neighbors;
  for (std::size_t seed = 0; seed < points.size(); ++seed) {
    if (taken[seed]) continue;
    taken[seed] = true;
    Indices cluster = {static_cast<std::int32_t>(seed)};
    for (std::size_t next = 0; next < cluster.size(); ++next) {
      search.Within(points[static_cast<std::size_t>(cluster[next])],
                    static_cast<float>(tolerance_m), &neighbors);
      for (const Neighbor& n : neighbors) {
        const auto index = static_cast<std::size_t>(n.index);
        if (taken[index]) continue;
        taken[index] = true;
        cluster.push_back(n.index);
      }
    }
    if (cluster.size() < min_count) continue;
    std::sort(cluster.begin(), cluster.end());
    clusters.push_back(std::move(cluster));
  }
  return clusters;
}

std::vector<Indices> JoinUnsupported(const Points& points, const PointSearch& search,
                                     const std::vector<double>& heights,
                                     std::vector<Indices> clusters, double max_gap_m) {
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
    const int support = NearestCluster(points, search, clusters[c], cluster_of, max_gap_m);
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
