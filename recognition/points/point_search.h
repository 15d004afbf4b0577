// Exact neighbours among the points of a cloud.
#pragma once

#include <limits>
#include <memory>
#include <vector>

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
  PointSearch& operator=(PointSearch&&) noexcept;

  // The nearest point; index -1 when there are no points.
  Neighbor Nearest(const Eigen::Vector3f& query) const;

  // The `count` nearest points (fewer if there are fewer), nearest first.
  void Nearest(const Eigen::Vector3f& query, int count, std::vector<Neighbor>* out) const;

  // All points within `radius` metres, in no particular but a fixed order.
  void Within(const Eigen::Vector3f& query, float radius, std::vector<Neighbor>* out) const;

 private:
  class Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace graspdb::recognition
