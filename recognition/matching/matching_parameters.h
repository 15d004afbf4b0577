// Parameters of the search and the alignment, with unit and default.
#pragma once

#include "recognition/base/pose_observer.h"

namespace graspdb::recognition {

// How the nearest views are aligned and judged.
struct MatchingParameters {
  // Number of candidates in an answer.
  int candidate_count = 10;
  // Nearest views whose stable poses are aligned first; the hypothesis that explains the scan
  // best wins. 1 trusts the descriptor alone and aligns that view's cloud, as the paper does.
  int verified_view_count = 20;
  // Views evaluated in all for a segment that these do not explain: among 2,040 views no
  // more was found with all of them (ADR 15). Doubled, unknown objects take up to twice as long.
  int further_view_count = 300;
  // Of those, the views evaluated for all segments of a frame together; the rest is counted as
  // untried. With three times as many, one of 162 partly hidden objects more is found (ADR 15).
  int further_view_budget = 400;
  // Deadline of the search for unexplained segments, s from the frame's beginning. Far more than
  // the budget takes, for an overloaded machine.
  double search_ceiling_s = 2;
  int icp_iteration_count = 50;
  // Correspondences farther apart than this are never used, m.
  double max_correspondence_m = 0.03;
  // Distance at which two points stop supporting each other in the score, m.
  double support_distance_m = 0.008;
  // An alignment that explains a smaller share of the segment is rejected; in the single-view
  // baseline, of the view.
  double min_inlier_fraction = 0.3;
  // A detection that scores lower is unknown, 0 to 1.
  double min_score = 0.5;
  // Whether a stable pose's own threshold replaces min_score.
  bool use_own_min_scores = true;
  // Empty: nothing is observed, and nothing takes longer. It changes no answer.
  PoseObserver observer = {};
};

}  // namespace graspdb::recognition
