// Objects that point pairs find in the part of a frame that no answer explains.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/answered_segment.h"
#include "recognition/frame/frame.h"
#include "recognition/matching/detection.h"
#include "recognition/models/taught.h"
#include "recognition/recognizer.h"
#include "recognition/scene/object_search.h"

namespace graspdb::recognition {

// What a frame is explained with. All references must outlive it.
struct SceneInput {
  const Scan& scan;
  const Segmentation& segmentation;
  const CatalogueSnapshot& catalogue;
  ViewClouds& clouds;
  const RecognitionParameters& parameters;
  const IsCancelled& is_cancelled;
};

// A pose of an object that the frame may show.
struct SceneProposal {
  StablePoses stable_poses;  // that `model` shows
  std::shared_ptr<const PairModel> model;
  SceneHypothesis hypothesis;
  float log_odds = 0;  // of the hypothesis by the image, see SceneScore
  // The rest is set by ConfirmProposals.
  Eigen::Isometry3f sensor_model = Eigen::Isometry3f::Identity();  // T_sensor_model
  Detection detection = {};                                        // without grasps
};

// The most likely poses of the taught objects by the image alone, the most likely first. The search
// takes 12 ms of processor time an object, on idle cores too. Errors as LoadPairModel; CANCELLED.
absl::StatusOr<std::vector<SceneProposal>> ProposeObjects(
    const SceneInput& input, const Frame& frame, const std::vector<AnsweredSegment>& answers);

// Aligns each proposal with the scan's points that lie on it, judges it on them, in the image and
// beside the other proposals, and leaves those that are accepted, the most likely first. About 2 ms
// of processor time a proposal. Errors as LoadModel; CANCELLED.
absl::Status ConfirmProposals(const SceneInput& input, const Frame& frame,
                              const std::vector<AnsweredSegment>& answers,
                              std::vector<SceneProposal>* proposals);

// The score of an answer that explains a segment: that of its own points, and what in the image
// speaks against it.
double AnswerScore(const Frame& frame, const SceneHypothesis& judged, double own,
                   const SceneParameters& scene);

}  // namespace graspdb::recognition
