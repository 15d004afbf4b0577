// Distinct hypotheses.
#pragma once

#include <cstddef>
#include <vector>

#include "recognition/matching/ranking.h"

namespace graspdb::recognition {

// Whether `b` is the model of `a` at `pose` (T_world_object): up to 4 mm and 4 degrees from there.
bool IsThere(const PoseHypothesis& a, const Pose& pose, const PoseHypothesis& b);

// Keeps the `count` hypotheses with the best evidence, the best first, without duplicates of a
// better one.
void KeepBest(std::size_t count, std::vector<PoseHypothesis>* hypotheses);

}  // namespace graspdb::recognition
