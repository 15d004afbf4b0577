// Recognition of one segment of a scan: descriptor, nearest views, models, pose, grasps.
#pragma once

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/search_budget.h"
#include "recognition/base/stages.h"
#include "recognition/matching/model_matching.h"
#include "recognition/recognizer.h"

namespace graspdb::recognition {

// Recognises a segment as one object, in two steps, of which the second continues the first. A
// segment that is too large to be one object, or too small for any answer to be accepted, is
// unknown without a search. Errors of `clouds`; CANCELLED. Not thread-safe; all references must
// outlive it.
class SegmentRecognition {
 public:
  SegmentRecognition(const MatchingInput& input, const ScanDepths& depths,
                     const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                     const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
                     StageLog* log);

  // Whether the nearest views explain the segment.
  absl::StatusOr<bool> TryNearest();

  // The answer. Where the nearest views do not explain the segment, tries as many further views as
  // `further` allows; none where that is null. Ends the search.
  absl::StatusOr<Detection> Answer(SearchBudget* further);

 private:
  bool FindNearest(int count);
  bool MayBeAccepted() const;
  ModelSearch& BeginSearch();
  absl::Status TakeBest();
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

// Null where it no longer exists.
const TaughtStablePose* StablePoseOf(const CatalogueSnapshot& catalogue,
                                     const Detection& detection);

// The minimum score of a detection of `taught`, which may be null.
double MinScore(const TaughtStablePose* taught, const MatchingParameters& parameters);

// Adds the turns of the declared symmetry and the grasps to a detection that is accepted, and sets
// its outcome. `taught` may be null.
void CompleteDetection(const TaughtStablePose* taught, const std::optional<Box>& workspace,
                       Detection* detection);

}  // namespace graspdb::recognition
