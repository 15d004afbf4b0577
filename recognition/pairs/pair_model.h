// An object's surface for the search by point pairs (Drost et al. 2010), and how it looks from
// every side.
#pragma once

#include <memory>
#include <vector>

#include "recognition/base/types.h"
#include "recognition/pairs/image_model.h"
#include "recognition/pairs/pair_table.h"

namespace graspdb::recognition {

struct PairModelParameters {
  // Spacing of the points: this share of the diameter, at least min_step_m metres, and as much more
  // as it takes to have at most max_points.
  float step_share = 0.05F;
  float min_step_m = 0.004F;
  std::size_t max_points = 450;
  std::size_t min_points = 20;
  ImageModelParameters surface;
  // Evenly spread sides from which the object is looked at.
  int direction_count = 200;
  // Of a stored aspect.
  std::size_t max_outline_points = 64;
};

// Immutable; safe for concurrent reads.
struct PairModel : ImageModel {
  OrientedCloud points;                // of the pairs, sparser than the surface
  float step_m = 0;                    // between their neighbours
  std::vector<ReferenceFrame> frames;  // of `points`
  std::unique_ptr<const PairTable> table;
  std::vector<ModelAspect> aspects;

  // The aspect from the direction nearest to `towards_camera` (object frame).
  const ModelAspect& AspectFrom(const Eigen::Vector3f& towards_camera) const;
  std::size_t bytes() const;
};

// From the points of a whole surface (object frame, m; unit normals outwards), or of as much of it
// as is known. Null with fewer than min_points points after thinning. Deterministic; about 0.2 s.
std::shared_ptr<const PairModel> MakePairModel(const OrientedCloud& surface,
                                               const PairModelParameters& parameters);

}  // namespace graspdb::recognition
