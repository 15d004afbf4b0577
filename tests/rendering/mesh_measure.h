// Measures on meshes for tests.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

#include "rendering/meshes/mesh.h"

namespace graspdb::rendering {

// Whether every directed edge and its reverse occur once: closed shells with consistently oriented
// triangles.
inline bool IsClosed(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (const std::array<int, 3>& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  return std::all_of(edges.begin(), edges.end(), [&edges](const auto& edge) {
    const auto reverse = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && reverse != edges.end() && reverse->second == 1;
  });
}

inline double VolumeOf(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&mesh](int i) -> Eigen::Vector3d {
      return mesh.vertices[static_cast<std::size_t>(i)].cast<double>();
    };
    volume += at(a).dot(at(b).cross(at(c))) / 6;
  }
  return volume;
}

// Distance from a point to a segment or a triangle.
inline float DistanceTo(const Eigen::Vector3f& p, const Eigen::Vector3f& a,
                        const Eigen::Vector3f& b) {
  const Eigen::Vector3f ab = b - a;
  const float t = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-20F), 0.0F, 1.0F);
  return (a + t * ab - p).norm();
}

inline float DistanceTo(const Eigen::Vector3f& p, const Eigen::Vector3f& a,
                        const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  const Eigen::Vector3f n = (b - a).cross(c - a).normalized();
  const bool above = (b - a).cross(p - a).dot(n) >= 0 && (c - b).cross(p - b).dot(n) >= 0 &&
                     (a - c).cross(p - c).dot(n) >= 0;
  if (above) return std::abs((p - a).dot(n));
  return std::min({DistanceTo(p, a, b), DistanceTo(p, b, c), DistanceTo(p, c, a)});
}

// Distance from a point to the surface; stops looking once it is below `enough`.
inline float DistanceTo(const TriangleMesh& mesh, const Eigen::Vector3f& p, float enough = 0) {
  float nearest = std::numeric_limits<float>::infinity();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&mesh](int i) -> const Eigen::Vector3f& {
      return mesh.vertices[static_cast<std::size_t>(i)];
    };
    nearest = std::min(nearest, DistanceTo(p, at(a), at(b), at(c)));
    if (nearest < enough) break;
  }
  return nearest;
}

}  // namespace graspdb::rendering
