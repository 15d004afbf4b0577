#include "recognition/scene/explained_clusters.h"

#include <algorithm>
#include <functional>

namespace graspdb::recognition {
namespace {

// A cluster of one object has no more of its pixels on others.
constexpr double kAlone = 0.1;

bool ShowsObject(PixelRole role) {
  return role == PixelRole::kObject || role == PixelRole::kExplained;
}

// The objects that are found in the clusters, one after the other.
class Explanation {
 public:
  Explanation(const Frame& frame, const ClusterPixels& clusters,
              const ClusterParameters& parameters)
      : frame_(frame),
        clusters_(clusters),
        parameters_(parameters),
        explained_(clusters.explained),
        members_(clusters.count.size(), 0),
        taken_(frame.depth.size(), false) {}

  // The cluster that the candidate is one object of; -1: none.
  int Add(const ClusterCandidate& candidate) {
    const int cluster = ClusterOf(candidate);
    if (cluster < 0) return cluster;
    const auto at = static_cast<std::size_t>(cluster);
    ++members_[at];
    for (const std::size_t p : candidate.pixels) {
      if (frame_.role[p] != PixelRole::kObject || taken_[p]) continue;
      taken_[p] = true;
      if (clusters_.cluster_of[p] == cluster) explained_[at] += 1;
    }
    return cluster;
  }

  bool IsComplete(int cluster) const {
    const auto at = static_cast<std::size_t>(cluster);
    const double share =
        IsOfSeveral(cluster) ? parameters_.min_explained : parameters_.min_explained_by_one;
    return explained_[at] >= share * clusters_.count[at];
  }

  bool IsOfSeveral(int cluster) const {
    const auto at = static_cast<std::size_t>(cluster);
    return members_[at] > 1 || clusters_.explained[at] > kAlone * clusters_.count[at];
  }

 private:
  int ClusterOf(const ClusterCandidate& candidate) const {
    std::vector<double> in(clusters_.count.size(), 0);
    double all = 0;
    double shared = 0;
    for (const std::size_t p : candidate.pixels) {
      if (frame_.role[p] != PixelRole::kObject) continue;
      all += 1;
      shared += taken_[p] ? 1 : 0;
      const int cluster = clusters_.cluster_of[p];
      if (cluster >= 0) in[static_cast<std::size_t>(cluster)] += 1;
    }
    const auto most = std::ranges::max_element(in);
    if (all == 0 || most == in.end()) return -1;
    const bool is_one =
        shared <= parameters_.max_shared * all && *most >= parameters_.min_inside * all;
    return is_one ? static_cast<int>(most - in.begin()) : -1;
  }

  const Frame& frame_;
  const ClusterPixels& clusters_;
  const ClusterParameters& parameters_;
  std::vector<double> explained_;
  std::vector<int> members_;
  std::vector<bool> taken_;
};

}  // namespace

ClusterPixels ClusterPixelsOf(const Scan& scan, const Frame& frame,
                              const std::vector<const Indices*>& clusters) {
  ClusterPixels out{.cluster_of = std::vector<int>(frame.depth.size(), -1),
                    .count = std::vector<double>(clusters.size(), 0),
                    .explained = std::vector<double>(clusters.size(), 0)};
  for (std::size_t cluster = 0; cluster < clusters.size(); ++cluster) {
    for (const std::int32_t i : *clusters[cluster]) {
      const std::ptrdiff_t at = frame.PixelOf(scan.PointAt(static_cast<std::size_t>(i)));
      if (at < 0) continue;
      const auto pixel = static_cast<std::size_t>(at);
      // A thinned frame has a pixel for several points.
      if (!ShowsObject(frame.role[pixel]) || out.cluster_of[pixel] == static_cast<int>(cluster))
        continue;
      out.cluster_of[pixel] = static_cast<int>(cluster);
      out.count[cluster] += 1;
      out.explained[cluster] += frame.role[pixel] == PixelRole::kExplained ? 1 : 0;
    }
  }
  return out;
}

std::vector<bool> CoveredClusters(const Frame& frame, const ClusterPixels& clusters,
                                  const std::vector<Pixels>& proposed, double min_share) {
  std::vector<double> covered = clusters.explained;
  std::vector<bool> counted(frame.depth.size(), false);
  for (const Pixels& pixels : proposed) {
    for (const std::size_t p : pixels) {
      const int cluster = clusters.cluster_of[p];
      if (cluster < 0 || counted[p] || frame.role[p] != PixelRole::kObject) continue;
      counted[p] = true;
      covered[static_cast<std::size_t>(cluster)] += 1;
    }
  }
  std::vector<bool> out(covered.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = covered[i] >= min_share * clusters.count[i];
  return out;
}

std::vector<bool> WhichExplainClusters(
    const Frame& frame, const ClusterPixels& clusters,
    const std::vector<std::optional<ClusterCandidate>>& candidates,
    const ClusterParameters& parameters) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i]) order.push_back(i);
  }
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t i) { return candidates[i]->log_odds; });
  Explanation explanation(frame, clusters, parameters);
  std::vector<int> cluster_of(candidates.size(), -1);
  for (const std::size_t i : order) cluster_of[i] = explanation.Add(*candidates[i]);
  std::vector<bool> out(candidates.size(), false);
  for (const std::size_t i : order) {
    const int cluster = cluster_of[i];
    out[i] = cluster >= 0 && explanation.IsComplete(cluster) &&
             (!explanation.IsOfSeveral(cluster) ||
              candidates[i]->confidence >= parameters.min_confidence_of_several);
  }
  return out;
}

}  // namespace graspdb::recognition
