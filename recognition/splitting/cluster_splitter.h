// Objects that touch, which the camera sees as one cluster.
#pragma once

#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/matching/model_matching.h"
#include "recognition/splitting/answered_segment.h"

namespace graspdb::recognition {

// Recognises a segment as if it stood alone.
using RecognizeAlone = std::function<absl::StatusOr<Detection>(const Segment&)>;

struct SplittingOptions {
  std::size_t min_count = 50;         // voxels of the smallest object
  double support_distance_m = 0.008;  // surfaces nearer than this are the same
  double voxel_size_m = 0.003;
};

// Parts `whole` into the objects that it consists of, where these are known; what touches something
// is marked.
//
// What the answer explains, or where there is none the answer for half of the segment, is taken
// away, and the rest is asked about. An object with an answer that leaves over as much as the
// smallest object touches something, known or not. A segment without an answer is parted only
// where all of it gets one: what was never taught must not be named for a part that resembles
// something. Halves are only looked at with `glance`, which may know less than `recognize` and is
// called from several threads.
// Deterministic. Errors as `recognize`; CANCELLED.
absl::StatusOr<std::vector<AnsweredSegment>> PartTouching(
    const MatchingInput& whole, Detection answer, const SplittingOptions& options,
    const RecognizeAlone& recognize, const RecognizeAlone& glance, const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
