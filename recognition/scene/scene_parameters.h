// Parameters of what is done without clusters.
#pragma once

#include <cstddef>

#include "recognition/frame/frame.h"
#include "recognition/scene/object_search.h"

namespace graspdb::recognition {

struct SceneParameters {
  // Off until its weights are fitted on more than 58 frames (docs/adr/0033).
  bool enabled = false;
  FrameParameters frame;
  ObjectSearchParameters search;
  // Log-odds (scene_score.h) at which an answer has the score 0.5: of a segment's, to which those
  // of its own confidence are added, and of one by point pairs alone.
  double segment_bar = -0.25;
  double pairs_bar = 1.2;
  // Objects are searched for in what the accepted answers leave over, where that is at least this
  // large, m2.
  double min_area_m2 = 8e-4;
  // At most so many objects are searched for, those first whose views resemble a segment.
  std::size_t max_objects = 40;
  // An object taught from views alone stands as it was taught, up to this tilt, rad.
  double max_tilt_rad = 0.26;
};

}  // namespace graspdb::recognition
