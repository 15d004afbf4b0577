// Clusters that several objects explain together.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "recognition/frame/frame.h"
#include "recognition/points/scan.h"
#include "recognition/scene/explained_pixels.h"

namespace graspdb::recognition {

// The pixels of a frame's clusters.
struct ClusterPixels {
  std::vector<int> cluster_of;    // of each pixel; -1: none
  std::vector<double> count;      // of each cluster
  std::vector<double> explained;  // of these
};

// Of the clusters with these points of the scan. O(points).
ClusterPixels ClusterPixelsOf(const Scan& scan, const Frame& frame,
                              const std::vector<const Indices*>& clusters);

// For each cluster, whether it is covered: the pixels of `proposed` together, and what is explained
// already, are at least `min_share` of it. O(pixels).
std::vector<bool> CoveredClusters(const Frame& frame, const ClusterPixels& clusters,
                                  const std::vector<Pixels>& proposed, double min_share);

// An object that may be one of a cluster's.
struct ClusterCandidate {
  Pixels pixels;          // that it explains
  double confidence = 0;  // in its own points, 0 to 1
  float log_odds = 0;     // by the image
};

struct ClusterParameters {
  // Several objects explain a cluster where so many of its pixels lie on one of them: 0.993 and
  // more in ideal clusters, 0.967 and more in real ones (docs/adr/0038).
  double min_explained = 0.96;
  // One object alone explains it where so many do. The cluster was compared with its views before,
  // as a segment, and had no answer.
  double min_explained_by_one = 0.99;
  // Of several objects each needs this confidence: parts of unknown objects resemble known ones
  // with up to 0.7 (docs/adr/0012).
  double min_confidence_of_several = 0.9;
  // And this SceneHypothesis::information: a single face fits on anything flat. That of right ones
  // is 0.21 and more, of bricks and boxes that were never taught 0.07 (docs/adr/0040).
  double min_information = 0.2;
  // Clusters that all proposals together cover less of, before they are aligned, are not looked at.
  double min_proposed = 0.9;
  // An object is one of a cluster where so many of its own pixels lie there.
  double min_inside = 0.8;
  // And where no more of them lie on a more likely object.
  double max_shared = 0.3;
};

// For each candidate, whether it is one of the objects that explain a cluster completely. What
// resembles an object and is part of something larger explains some of a cluster, seldom all of it.
// Takes the most likely first. Deterministic. O(k pixels) for k candidates.
std::vector<bool> WhichExplainClusters(
    const Frame& frame, const ClusterPixels& clusters,
    const std::vector<std::optional<ClusterCandidate>>& candidates,
    const ClusterParameters& parameters);

}  // namespace graspdb::recognition
