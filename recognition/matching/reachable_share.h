// Share of a segment that an object of a given size can cover.
#pragma once

#include <cstddef>
#include <vector>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// Upper bounds of the share of some points that lie on an object, wherever it is. Immutable.
class ReachableShare {
 public:
  // Takes every `stride`th point. O(n log n) in these.
  ReachableShare(const Points& points, std::size_t stride);

  // Of those in a sphere of `radius_m`, 0 to 1; 1 where there are no points: no more than lie
  // between two vertical planes along x as far apart as it is wide, and two such along y. O(1).
  double Within(float radius_m) const;

  // Of those that are not higher than `z_m`, 0 to 1. O(log n).
  double NotHigher(float z_m) const;

 private:
  static constexpr int kCells = 32;  // along x and along y
  float cell_m_ = 1;
  // Points in the cells before x and y.
  Eigen::ArrayXXi sums_ = Eigen::ArrayXXi::Zero(kCells + 1, kCells + 1);
  std::vector<float> heights_;  // ascending
};

}  // namespace graspdb::recognition
