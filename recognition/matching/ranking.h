// Which of several explanations is the best, and which are as good.
#pragma once

#include <memory>
#include <vector>

#include "recognition/models/taught.h"
#include "recognition/verification/verification.h"

namespace graspdb::recognition {

// How an explanation compares with the best one.
enum class RankClass {
  kBest,
  kSameSurface,  // puts a surface where the best one does: a turn of something symmetric
  kAsGood,       // puts it elsewhere, and what was measured does not tell which is right
  kWorse,
};

// An explanation of a segment.
struct PoseHypothesis {
  std::shared_ptr<const TaughtView> view;  // that gave rise to it
  std::shared_ptr<const SurfaceModel> model;
  int symmetry_order = 1;         // of the stable pose, as it was declared
  Pose rough = Pose::Identity();  // T_world_object
  Pose refined = Pose::Identity();
  int iterations = 0;      // of the last refinement
  bool finished = false;   // refined in full
  bool recentred = false;  // after the refinement, see settling.h
  bool polished = false;   // refined again until nothing changed
  Evidence evidence;       // within the support distance
  double close_score = 0;  // within the noise of the scan
  RankClass rank_class = RankClass::kWorse;
};

// Sorts `hypotheses` by how well they explain the scan within the noise that the first one of them
// leaves, `support_distance_m` at most; objects that differ by some millimetres differ there. Sets
// close_score and rank_class. Deterministic.
void RankClosely(const SoaCloud& segment, const DepthBuffer& depth_buffer,
                 double support_distance_m, std::vector<PoseHypothesis>* hypotheses);

// The largest distance between two posed surfaces, from either to the other, m; no more than
// what their grids reach.
double LargestGap(const SurfaceModel& a, const Pose& world_a, const SurfaceModel& b,
                  const Pose& world_b);

}  // namespace graspdb::recognition
