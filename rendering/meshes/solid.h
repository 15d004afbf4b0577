// Closed solids made by code, without booleans: a workpiece is a union of closed
// shells that overlap. Unit-free. Outside is where triangles turn
// counter-clockwise.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rendering/meshes/mesh.h"

namespace graspdb::rendering {

// Corners of a simple polygon (no edge crosses another), counter-clockwise.
using Polygon = std::vector<Eigen::Vector2f>;

// `sides` corners at `radius` around `center`, the first at `first_rad` from x.
Polygon RegularPolygon(const Eigen::Vector2f& center, float radius, int sides, float first_rad);

// The box between two corners.
TriangleMesh BoxSolid(const Eigen::Vector3f& min, const Eigen::Vector3f& max);

// A polygon in x and y between the heights z0 < z1; it need not be convex.
TriangleMesh ExtrudeUp(const Polygon& polygon, float z0, float z1);

// A profile in x and z between y0 < y1.
TriangleMesh ExtrudeAlongY(const Polygon& profile, float y0, float y1);

// A profile in y and z between x0 < x1.
TriangleMesh ExtrudeAlongX(const Polygon& profile, float x0, float x1);

// An upright cylinder with many sides.
TriangleMesh CylinderSolid(const Eigen::Vector2f& center, float radius, float z0, float z1);

// An upright prism with a hole, from z = 0 up: loops with as many corners each, `inner` inside
// `outer`, corner k of one in the direction of corner k of the other from the middle.
TriangleMesh RingSolid(const Polygon& outer, const Polygon& inner, float height);

// Adds the shells of `other` to `mesh`.
void Append(TriangleMesh& mesh, const TriangleMesh& other);

// The union of shells.
TriangleMesh Union(const std::vector<TriangleMesh>& shells);

// The mirror image in the plane x = 0.
TriangleMesh MirroredX(const TriangleMesh& mesh);

}  // namespace graspdb::rendering
