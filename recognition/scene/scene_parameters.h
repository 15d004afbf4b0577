// Parameters of what is done without clusters.
#pragma once

#include <cstddef>

#include "recognition/frame/frame.h"
#include "recognition/scene/object_search.h"

namespace graspdb::recognition {

struct SceneParameters {
  // Whether the image judges the answers of segments.
  bool verify = true;
  // Whether objects are searched for by point pairs in what the answers leave over, which takes 25
  // ms of processor time an object.
  bool search = false;
  FrameParameters frame;
  ObjectSearchParameters object_search;
  // Log-odds (scene_score.h) at which an answer has the score 0.5: of a segment's, to which those
  // of its own confidence are added, and of one by point pairs alone.
  double segment_bar = -1.25;
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
