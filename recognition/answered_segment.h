// A segment and what was recognised in it.
#pragma once

#include "recognition/recognizer.h"

namespace graspdb::recognition {

struct AnsweredSegment {
  Segment segment;
  Detection detection;
};

}  // namespace graspdb::recognition
