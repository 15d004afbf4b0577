// Touching objects, which the camera sees as one cluster.
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

// Splits `whole` into its objects, where these are known, and marks touching ones.
//
// Removes the points that the answer explains, or without one those of the answer for half of the
// segment, and recognises the rest. An object whose answer leaves over as much as the smallest
// object touches another one, known or not. A segment without an answer is split only where all of
// it gets one: an unknown object must not be named for a part that resembles a known one.
// Recognises halves with `glance` only, which may be less accurate than `recognize` and is called
// from several threads. Deterministic. Errors as `recognize`; CANCELLED.
absl::StatusOr<std::vector<AnsweredSegment>> PartTouching(
    const MatchingInput& whole, Detection answer, const SplittingOptions& options,
    const RecognizeAlone& recognize, const RecognizeAlone& glance, const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
