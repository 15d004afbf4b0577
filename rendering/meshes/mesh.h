// Triangle meshes and their measures. Thread-safe.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::rendering {

// Triangles over shared vertices, in metres. The corners of a triangle turn
// counter-clockwise seen from outside. A solid may be a union of closed shells
// that overlap.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<int, 3>> triangles;
};

// The i-th of `count` directions spread evenly over the sphere (a Fibonacci lattice).
Eigen::Vector3f EvenDirection(int i, int count);

// INVALID_ARGUMENT when there is no triangle, an index is out of range or a
// vertex is not finite.
absl::Status CheckMesh(const TriangleMesh& mesh);

// The smallest box around the vertices; all zero without vertices.
recognition::Box BoundsOf(const TriangleMesh& mesh);

// The largest distance between two vertices, as ADD-S thresholds need it. Exact
// up to 4096 vertices, otherwise at most 0.2 % too small. Deterministic.
double DiameterOf(const TriangleMesh& mesh);

// Of all triangles, also those inside a union of shells, m^2.
double AreaOf(const TriangleMesh& mesh);

// `count` points on the surface, uniform by area, the same for the same seed.
// Faces inside a union of shells are sampled too. None without triangles.
recognition::Points SampleSurface(const TriangleMesh& mesh, int count, std::uint64_t seed);

// The same points with the normals of their triangles, which point outwards.
recognition::OrientedCloud SampleOrientedSurface(const TriangleMesh& mesh, int count,
                                                 std::uint64_t seed);

// Centre of mass of the solid, of constant density; where shells overlap the
// mass counts twice. FAILED_PRECONDITION when the mesh encloses no volume.
absl::StatusOr<Eigen::Vector3d> CenterOfMass(const TriangleMesh& mesh);

// T * mesh.
TriangleMesh Transformed(const TriangleMesh& mesh, const recognition::Pose& pose);

}  // namespace graspdb::rendering
