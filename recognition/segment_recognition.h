// What one segment of a scan is: descriptor, nearest views, models, pose, grasps.
#pragma once

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/model_matching.h"
#include "recognition/recognizer.h"
#include "recognition/search_budget.h"
#include "recognition/stages.h"

namespace graspdb::recognition {

// Recognises a segment as one object, in two steps of which the second goes on where the first
// ended. A segment that is too large to be one object is unknown. Errors of `clouds`; CANCELLED.
// Not thread-safe; all references must outlive it.
class SegmentRecognition {
 public:
  SegmentRecognition(const MatchingInput& input, const ScanDepths& depths,
                     const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                     const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
                     StageLog* log);

  // Whether the nearest views explain the segment.
  absl::StatusOr<bool> TryNearest();

  // The answer. Where the nearest views do not explain the segment, of as many further
  // views as `further` allows. Ends it.
  absl::StatusOr<Detection> Answer(SearchBudget& further);

 private:
  bool FindNearest();
  void TakeBest(const std::vector<PoseHypothesis>& hypotheses);
  void Decide();

  const MatchingInput input_;
  const ScanDepths& depths_;
  const CatalogueSnapshot& catalogue_;
  ViewClouds& clouds_;
  const RecognitionParameters& parameters_;
  const IsCancelled& is_cancelled_;
  StageLog* log_;
  Detection out_;
  std::optional<Descriptor> descriptor_;
  std::vector<Match> matches_;
  std::optional<ModelSearch> search_;
  bool explained_ = false;
};

}  // namespace graspdb::recognition
