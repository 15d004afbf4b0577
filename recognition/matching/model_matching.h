// Search for the stable pose and pose of one segment: the views it tries, and in which order.
#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/matching/segment_matcher.h"

namespace graspdb::recognition {

// Input of a search: one segment of a scan.
struct MatchingInput {
  const Scan& scan;
  const Segmentation& segmentation;
  const Segment& segment;
};

// The search for the hypotheses that explain a segment best. It can stop after the nearest views
// and continue later without repeated work. Stable poses without a model are left out.
// Deterministic but for the budget's clock. Not thread-safe; all references must outlive it.
class ModelSearch {
 public:
  // `nearest` is not empty and contains the views with the descriptors most similar to
  // `descriptor`, that of the segment.
  ModelSearch(const MatchingInput& input, const ScanDepths& depths, Descriptor descriptor,
              std::span<const Match> nearest, const CatalogueSnapshot& catalogue,
              ViewClouds& clouds, const MatchingParameters& parameters,
              const IsCancelled& is_cancelled);

  // Tries the stable poses and azimuths of the nearest views; returns whether they explain the
  // segment. Errors as LoadModel; CANCELLED.
  absl::StatusOr<bool> TryNearest();

  // Where they do not, or a part of the segment is hidden so that its descriptor is not
  // distinctive, tries further views, the most similar first: at most
  // MatchingParameters::further_view_count (kCutOffViews times as many for a partly hidden segment)
  // and as many as the budget allows. Where none of these explains anything and an answer is
  // required (min_score 0), the nearest view alone.
  absl::Status TryFurther(SearchBudget& budget);

  // Ranked (see RankClosely), different from each other. Ends the search. CANCELLED.
  absl::StatusOr<std::vector<PoseHypothesis>> TakeRanked() { return matcher_.TakeRanked(); }

 private:
  bool IsCutOff() const { return hidden_ != DepthBuffer::Sides{}; }
  Views FurtherViews(const DepthBuffer::Sides& unseen) const;

  const Descriptor descriptor_;
  const CatalogueSnapshot& catalogue_;
  const MatchingParameters& parameters_;
  SegmentMatcher matcher_;
  const DepthBuffer::Sides hidden_;
  Views nearest_;
};

}  // namespace graspdb::recognition
