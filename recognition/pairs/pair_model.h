// An object's surface for the search by point pairs (Drost et al. 2010), and how it looks from
// every side.
#pragma once

#include <memory>
#include <vector>

#include "recognition/base/types.h"
#include "recognition/pairs/model_aspect.h"
#include "recognition/pairs/pair_table.h"

namespace graspdb::recognition {

struct PairModelParameters {
  // Spacing of the points: this share of the diameter, at least min_step_m metres, and as much more
  // as it takes to have at most max_points.
  float step_share = 0.05F;
  float min_step_m = 0.004F;
  std::size_t max_points = 450;
  std::size_t min_points = 20;
  // Points of the denser surface that hypotheses are refined and judged on.
  std::size_t max_surface_points = 4000;
  float min_surface_step_m = 0.0025F;
  // Evenly spread sides from which the object is looked at.
  int direction_count = 200;
  // Of a stored aspect.
  std::size_t max_outline_points = 64;
};

// Immutable; safe for concurrent reads.
struct PairModel {
  OrientedCloud points;                              // of the pairs; object frame, m
  OrientedCloud surface;                             // denser, for refinement and verification
  float step_m = 0;                                  // between neighbours of `points`
  float surface_step_m = 0;                          // and of `surface`
  float diameter_m = 0;                              // of the sphere around the center
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  // of the bounding box
  std::vector<ReferenceFrame> frames;                // of `points`
  std::unique_ptr<const PairTable> table;
  std::vector<ModelAspect> aspects;

  // The aspect from the direction nearest to `towards_camera` (object frame).
  const ModelAspect& AspectFrom(const Eigen::Vector3f& towards_camera) const;
  // What a camera at this place (object frame, m) sees. O(n) in the surface, about 0.1 ms.
  ModelAspect AspectSeenFrom(const Eigen::Vector3f& camera, std::size_t max_outline_points) const;
  std::size_t bytes() const;
};

// From the points of a whole surface (object frame, m; unit normals outwards), or of as much of it
// as is known. Null with fewer than min_points points after thinning. Deterministic; about 0.2 s.
std::shared_ptr<const PairModel> MakePairModel(const OrientedCloud& surface,
                                               const PairModelParameters& parameters);

}  // namespace graspdb::recognition
