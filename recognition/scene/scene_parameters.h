// Parameters of what is done without clusters.
#pragma once

#include <cstddef>

#include "recognition/frame/frame.h"
#include "recognition/scene/explained_clusters.h"
#include "recognition/scene/object_search.h"
#include "recognition/scene/scene_score.h"

namespace graspdb::recognition {

struct SceneParameters {
  // Whether the image judges the answers of segments.
  bool verify = true;
  // Whether objects are searched for by point pairs in what the answers leave over, which takes 25
  // ms of processor time an object.
  bool search = true;
  FrameParameters frame;
  ObjectSearchParameters object_search;
  // Log-odds (scene_score.h) at which a segment's answer has the score 0.5; those of its own
  // confidence are added.
  double segment_bar = -0.5;
  // How much counts against a segment's answer that its pose is unlikely by the image alone, where
  // what is not seen counts as well: a share of its log-odds under 0.
  double unlikely_weight = 0.2;
  // Proposals of the search that are less likely by the image alone, log-odds, are dropped, and so
  // are all but so many.
  float min_proposal_log_odds = -7;
  // And those below this, where they cannot explain a cluster together with others.
  float min_log_odds = -4;
  std::size_t max_proposals = 64;
  ProposalWeights proposal;
  // Proposals that explain a cluster completely are judged as its answers, by segment_bar.
  ClusterParameters clusters;
  // Objects are searched for in what the accepted answers leave over, where that is at least this
  // large, m2.
  double min_area_m2 = 8e-4;
  // At most so many objects are searched for, those first whose views resemble a segment.
  std::size_t max_objects = 40;
  // An object taught from views alone stands as it was taught, up to this tilt, rad.
  double max_tilt_rad = 0.26;
};

}  // namespace graspdb::recognition
