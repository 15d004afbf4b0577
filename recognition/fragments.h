// Pieces of one object in several segments.
#pragma once

#include <cstddef>
#include <vector>

#include "recognition/answered_segment.h"
#include "recognition/base/cancellation.h"

namespace graspdb::recognition {

// Whether four fifths of a segment lie on the posed model of a detection that has one. O(n) for n
// points.
bool LiesOn(const Segment& segment, const Detection& whole, double support_distance_m);

// An object that hides its own middle, or stands behind something thin, is seen as several
// segments. One that lies on the posed model of a detection is a piece of that where it has no
// answer, or the same object's with no higher score: it is removed, and its points and centroid are
// counted there. Surfaces nearer than `support_distance_m` are the same. Deterministic. O(k² n) for
// k segments with n points.
void JoinFragments(double support_distance_m, std::vector<AnsweredSegment>* answers);

// Whether an answer leaves over as much of its segment as the smallest object: then something else
// touches it, known or not. Pieces have at least `min_count` voxels of `voxel_size_m`. O(n).
bool LeavesPieces(const AnsweredSegment& answer, double support_distance_m, double voxel_size_m,
                  std::size_t min_count, const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
