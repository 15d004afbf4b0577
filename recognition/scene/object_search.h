// Where in a frame an object may be, without clusters.
#pragma once

#include <vector>

#include "recognition/base/cancellation.h"
#include "recognition/frame/frame.h"
#include "recognition/pairs/pair_model.h"
#include "recognition/pairs/pair_votes.h"
#include "recognition/scene/image_evidence.h"
#include "recognition/scene/image_refinement.h"

namespace graspdb::recognition {

struct ObjectSearchParameters {
  PairVotesParameters votes;
  ImageEvidenceParameters evidence;
  // Each voted pose is checked with so many points; the best screened_count get a short refinement,
  // of these refined_count a longer one, and kept_count are left.
  std::size_t check_points = 64;
  std::size_t screened_count = 120;
  std::size_t refined_count = 24;
  std::size_t kept_count = 12;
  // Candidates that score less after the check, the short and the longer refinement end there: a
  // right one that is accepted scores more.
  float min_checked_score = 0.25F;
  float min_refined_score = 0.40F;
  float min_kept_score = 0.50F;
  // Of these, at one place.
  std::size_t screened_at_one_place = 4;
  std::size_t refined_at_one_place = 2;
  std::size_t kept_at_one_place = 1;
  ImageRefinementParameters first_steps = {
      .iterations = 3, .first_reach_m = 0.025F, .last_reach_m = 0.012F, .max_points = 64};
  ImageRefinementParameters last_steps = {
      .iterations = 7, .first_reach_m = 0.012F, .last_reach_m = 0.006F, .max_points = 160};
};

// A pose of a model in a frame, and what the frame says about it.
struct SceneHypothesis {
  Eigen::Isometry3f sensor_object = Eigen::Isometry3f::Identity();
  SurfaceEvidence surface;
  OutlineEvidence outline;
  HeightRange heights;    // over the table
  float information = 0;  // see InformationOf
  float score = 0;        // for the order of hypotheses, 0 to 1
};

// Points of a frame's object pixels, one a cell of `cell_m` metres. Sensor frame.
OrientedCloud SceneSample(const Frame& frame, float cell_m);

// The best hypotheses, different from each other, the best first. `sample` is SceneSample with
// about the model's step. Deterministic. Meaningless once cancelled.
std::vector<SceneHypothesis> SearchObject(const Frame& frame, const OrientedCloud& sample,
                                          const PairModel& model,
                                          const ObjectSearchParameters& parameters,
                                          const IsCancelled& is_cancelled);

// All that the frame says about a pose.
SceneHypothesis JudgePose(const Frame& frame, const PairModel& model,
                          const Eigen::Isometry3f& sensor_object,
                          const ObjectSearchParameters& parameters);

}  // namespace graspdb::recognition
