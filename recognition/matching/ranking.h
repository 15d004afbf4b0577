// Ranking of the hypotheses about a segment.
#pragma once

#include <memory>
#include <vector>

#include "recognition/models/taught.h"
#include "recognition/verification/verification.h"

namespace graspdb::recognition {

// How a hypothesis compares with the best one.
enum class RankClass {
  kBest,
  kSameSurface,  // same surface as the best one: a turn of a symmetric object
  kAsGood,       // another place; the measurements do not distinguish them
  kWorse,
};

// A hypothesis about a segment.
struct PoseHypothesis {
  std::shared_ptr<const TaughtView> view;  // that it was made from
  std::shared_ptr<const SurfaceModel> model;
  int symmetry_order = 1;         // of the stable pose, as it was declared
  Pose rough = Pose::Identity();  // T_world_object
  Pose refined = Pose::Identity();
  int iterations = 0;      // of all refinements
  bool converged = false;  // the last one
  bool finished = false;   // refined in full
  bool recentred = false;  // after the refinement, see recentring.h
  bool polished = false;   // refined again until nothing changed
  Evidence evidence;       // within the support distance
  double close_score = 0;  // within the noise of the scan
  RankClass rank_class = RankClass::kWorse;
};

// Sorts `hypotheses` by how well they explain the scan within the residual noise of the first one,
// `support_distance_m` at most, which separates objects that differ by some millimetres. Sets
// close_score and rank_class. Deterministic.
void RankClosely(const SoaCloud& segment, const DepthBuffer& depth_buffer,
                 double support_distance_m, std::vector<PoseHypothesis>* hypotheses);

// The largest distance between two posed surfaces, from either to the other, m; infinite where it
// exceeds the reach of their grids.
double LargestGap(const SurfaceModel& a, const Pose& world_a, const SurfaceModel& b,
                  const Pose& world_b);

}  // namespace graspdb::recognition
