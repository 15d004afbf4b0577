// A segment and its detection.
#pragma once

#include "recognition/matching/detection.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {

struct AnsweredSegment {
  Segment segment;
  Detection detection;
  const Segment* seen = nullptr;  // as it was found in the scan; null for a part of one
};

}  // namespace graspdb::recognition
