// Pieces of one thing that the camera saw apart.
#pragma once

#include <vector>

#include "recognition/recognizer.h"

namespace graspdb::recognition {

// A thing that hides its own middle, or behind something thin, is seen as several segments. A
// detection without an answer whose segment lies on the posed model of one that has an answer is a
// piece of that: it is removed, and its points and centroid are counted there. `detections[i]` came
// of `segments[i]`; surfaces nearer than `support_distance_m` are the same. Deterministic.
void JoinFragments(const std::vector<Segment>& segments, double support_distance_m,
                   std::vector<Detection>* detections);

}  // namespace graspdb::recognition
