// Poses of a model that pairs of scene points vote for (Drost et al. 2010, section 3).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
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

// A model whose poses are voted for.
struct Voting {
  const PairModel* model = nullptr;
  // Where set, only poses count whose z axis is no farther from `up` (the scene's frame, unit
  // length) than this cosine allows.
  struct Upright {
    Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
    float min_cosine = -1;
  };
  std::optional<Upright> upright = std::nullopt;
};

using VotedPoses = std::vector<Eigen::Isometry3f>;

// Poses of each model in the frame of `scene` (m, unit normals towards the sensor), at most
// reference_count * peak_count of them. The pairs of the scene are made once for all models.
// Deterministic, on idle cores too. O(m r n) for m models, r references and n points of the scene.
// Meaningless once cancelled.
std::vector<VotedPoses> VoteForPoses(std::span<const Voting> models, const OrientedCloud& scene,
                                     const PairVotesParameters& parameters,
                                     const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
