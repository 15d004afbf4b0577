// The nearest point of a cloud, exactly.
#pragma once

#include <limits>
#include <memory>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// A point found by a search.
struct Neighbor {
  int index = -1;
  float squared_distance = std::numeric_limits<float>::infinity();  // m^2
};

// A search structure over a copy of `points`, which must be finite. Exact and deterministic; safe
// for concurrent searches. The only user of FLANN's kd-tree.
class PointSearch {
 public:
  explicit PointSearch(const Points& points);
  ~PointSearch();
  PointSearch(PointSearch&&) noexcept;

  // The nearest point; index -1 when there are no points.
  Neighbor Nearest(const Eigen::Vector3f& query) const;

 private:
  class Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace graspdb::recognition
