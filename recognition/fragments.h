// Pieces of one thing that the camera saw apart.
#pragma once

#include <vector>

#include "recognition/answered_segment.h"

namespace graspdb::recognition {

// A thing that hides its own middle, or behind something thin, is seen as several segments. One
// without an answer that lies on the posed model of one that has an answer is a piece of
// that: it is removed, and its points and centroid are counted there. Surfaces nearer than
// `support_distance_m` are the same. Deterministic.
void JoinFragments(double support_distance_m, std::vector<AnsweredSegment>* answers);

}  // namespace graspdb::recognition
