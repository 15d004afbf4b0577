// Whether a mesh stands, computed without hulls and facets.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "rendering/meshes/mesh.h"

namespace graspdb::client {

// The centre of mass of the solid within the mesh: columns over its triangles, weighed one by one.
inline Eigen::Vector3d WeighedCenter(const rendering::TriangleMesh& mesh) {
  double volume = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&mesh](int i) -> Eigen::Vector3d {
      return mesh.vertices[static_cast<std::size_t>(i)].cast<double>();
    };
    const Eigen::Vector3d p = at(a);
    const Eigen::Vector3d q = at(b);
    const Eigen::Vector3d r = at(c);
    const double ground = ((q - p).cross(r - p)).z() / 2;  // area of the shadow, with its sign
    volume += ground * (p.z() + q.z() + r.z()) / 3;
    // Integrals of x z, y z and z^2 / 2 over the shadow of a plane triangle.
    const double z2 = (p.z() * p.z() + q.z() * q.z() + r.z() * r.z() + p.z() * q.z() +
                       q.z() * r.z() + r.z() * p.z()) /
                      12;
    const auto mixed = [&](int i) {
      return ((p[i] + q[i] + r[i]) * (p.z() + q.z() + r.z()) + p[i] * p.z() + q[i] * q.z() +
              r[i] * r.z()) /
             12;
    };
    moment += ground * Eigen::Vector3d(mixed(0), mixed(1), z2);
  }
  return moment / volume;
}

// The largest angle in which no point lies, seen from `foot` (x and y): less than half a turn when
// the foot is among the points, rad.
inline double LargestGap(const Eigen::Vector3d& foot, const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> angles;
  angles.reserve(points.size());
  for (const Eigen::Vector3d& p : points) {
    angles.push_back(std::atan2(p.y() - foot.y(), p.x() - foot.x()));
  }
  std::ranges::sort(angles);
  if (angles.empty()) return 2 * std::numbers::pi;
  double gap = 2 * std::numbers::pi + angles.front() - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap;
}

// The vertices of a posed mesh that touch the table.
inline std::vector<Eigen::Vector3d> Touching(const rendering::TriangleMesh& posed,
                                             double tolerance_m) {
  float lowest = std::numeric_limits<float>::infinity();
  for (const auto& v : posed.vertices) lowest = std::min(lowest, v.z());
  std::vector<Eigen::Vector3d> out;
  for (const auto& v : posed.vertices) {
    if (static_cast<double>(v.z() - lowest) <= tolerance_m) out.push_back(v.cast<double>());
  }
  return out;
}

// The posed mesh stands on the table z = 0: its lowest points are there, and its centre of mass is
// over their convex hull.
inline bool Stands(const rendering::TriangleMesh& posed) {
  constexpr double kTouchingM = 5e-5;
  const std::vector<Eigen::Vector3d> touching = Touching(posed, kTouchingM);
  return touching.size() >= 3 && std::abs(touching.front().z()) < 2 * kTouchingM &&
         LargestGap(WeighedCenter(posed), touching) < std::numbers::pi;
}

}  // namespace graspdb::client
