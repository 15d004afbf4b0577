// Where in a frame an object may be, without clusters.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "recognition/base/cancellation.h"
#include "recognition/base/pose_observer.h"
#include "recognition/frame/frame.h"
#include "recognition/pairs/pair_model.h"
#include "recognition/pairs/pair_votes.h"
#include "recognition/scene/image_evidence.h"
#include "recognition/scene/image_refinement.h"

namespace graspdb::recognition {

// Which candidates go on to the next step.
struct SelectionParameters {
  std::size_t points = 64;     // of the surface that are looked up, see LookAtSurface
  float tolerance_factor = 1;  // see LookAtSurface
  float min_score = 0;         // 0 to 1; a right pose that is accepted in the end scores more
  std::size_t count = 100;
  // With their centres in one cell of half a diameter: a large neighbour that explains a model
  // badly in a hundred ways must not end the search elsewhere.
  std::size_t at_one_place = 1;
};

struct ObjectSearchParameters {
  PairVotesParameters votes;
  ImageEvidenceParameters evidence;
  // Each voted pose is checked; the best of them get a short refinement, the best of these a longer
  // one, and the best of these are left.
  SelectionParameters checked = {
      .points = 64, .tolerance_factor = 2, .min_score = 0.25F, .count = 120, .at_one_place = 4};
  SelectionParameters screened = {
      .points = 64, .tolerance_factor = 1.5F, .min_score = 0.40F, .count = 24, .at_one_place = 2};
  SelectionParameters refined = {
      .points = 160, .tolerance_factor = 1, .min_score = 0.50F, .count = 12, .at_one_place = 1};
  // Points of the surface and of the outline that a pose is judged on at the end.
  std::size_t judged_points = 400;
  std::size_t judged_outline_points = 96;
  ImageRefinementParameters first_steps = {
      .iterations = 3, .first_reach_m = 0.025F, .last_reach_m = 0.012F, .max_points = 64};
  ImageRefinementParameters last_steps = {
      .iterations = 7, .first_reach_m = 0.012F, .last_reach_m = 0.006F, .max_points = 160};
};

// A pose of a model in a frame, and what the frame says about it.
struct SceneHypothesis {
  Eigen::Isometry3f sensor_object = Eigen::Isometry3f::Identity();  // T_sensor_object
  SurfaceEvidence surface;
  OutlineEvidence outline;
  std::optional<float> clearance_m;  // over the table, see ClearanceOver; absent: no table
  float information = 0;             // see InformationOf
  float score = 0;                   // for the order of hypotheses, 0 to 1
};

// Points of a frame's object pixels. Sensor frame.
OrientedCloud ObjectPoints(const Frame& frame);

// Gets the poses (T_sensor_object) that a step of the search leaves.
using SearchObserver = std::function<void(PoseStep, std::span<const Eigen::Isometry3f>)>;

// The best hypotheses of a model, different from each other, the best first. `voted` are from
// ObjectPoints, one a cell of about the model's step. `observer` may be empty. Deterministic.
// Meaningless once cancelled.
std::vector<SceneHypothesis> SearchObject(const Frame& frame, const PairModel& model,
                                          const VotedPoses& voted,
                                          const ObjectSearchParameters& parameters,
                                          const IsCancelled& is_cancelled,
                                          const SearchObserver& observer = {});

// All that the frame says about a pose.
SceneHypothesis JudgePose(const Frame& frame, const ImageModel& model,
                          const Eigen::Isometry3f& sensor_object,
                          const ObjectSearchParameters& parameters);

}  // namespace graspdb::recognition
