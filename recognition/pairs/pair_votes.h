// Poses of a model that pairs of scene points vote for (Drost et al. 2010, section 3).
#pragma once

#include <cstdint>
#include <vector>

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"
#include "recognition/pairs/pair_model.h"

namespace graspdb::recognition {

struct PairVotesParameters {
  // Scene points that vote, evenly chosen; each takes all partners within the model's diameter.
  std::size_t reference_count = 100;
  // Poses of each.
  std::size_t peak_count = 2;
};

// Poses of the model in the frame of `scene` (m, unit normals towards the sensor), at most
// reference_count * peak_count of them. Deterministic. O(r n) for r references and n points of the
// scene. Meaningless once cancelled.
std::vector<Eigen::Isometry3f> VotedPoses(const PairModel& model, const OrientedCloud& scene,
                                          const PairVotesParameters& parameters,
                                          const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
