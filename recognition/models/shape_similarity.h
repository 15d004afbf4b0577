// Similarity of two objects, and of one object to itself turned about the vertical.
#pragma once

#include <optional>

#include "recognition/models/surface_model.h"

namespace graspdb::recognition {

// Distances of the points of either surface from the other, m.
struct Gap {
  double mean_m = 0;
  double largest_m = 0;  // of 95 % of them: single points are noise
};

// Surfaces with a smaller gap (`largest_m`) are one shape to a depth camera: 2.5 mm, or a share of
// the object's size, up to 9 mm. Up to NearlyAlikeM they may be taken for each other where a part
// is hidden or the camera noisy.
double AlikeM(const SurfaceModel& model);
double NearlyAlikeM(const SurfaceModel& model);

// Turns about z that map an object onto itself, seen from all taught sides.
struct FoundSymmetry {
  int order = 1;        // 1 none, n for n-fold up to 12, 0 for any turn
  bool nearly = false;  // only NearlyAlikeM
  Gap gap;              // the largest of its turns; meaningless for order 1
};
FoundSymmetry FindSymmetry(const SurfaceModel& model);

// `a` on `b`, both on the table, in the turn that fits best: T_b_a and the gap.
struct ShapeSimilarity {
  Pose b_a = Pose::Identity();
  Gap gap;
};
// nullopt where they differ by more than NearlyAlikeM. Deterministic.
std::optional<ShapeSimilarity> FindShapeSimilarity(const SurfaceModel& a, const SurfaceModel& b);

}  // namespace graspdb::recognition
