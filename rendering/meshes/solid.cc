#include "rendering/meshes/solid.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace graspdb::rendering {
namespace {

constexpr int kCylinderSides = 64;

using Triangle = std::array<int, 3>;

float Cross(const Eigen::Vector2f& o, const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

const Eigen::Vector2f& At(const Polygon& polygon, int i) {
  return polygon[static_cast<std::size_t>(i)];
}

// Whether the corner b between a and c can be cut off: it turns left and no
// other corner lies within the triangle.
bool IsEar(const Polygon& polygon, const std::vector<int>& left, const Triangle& ear) {
  const Eigen::Vector2f& a = At(polygon, ear[0]);
  const Eigen::Vector2f& b = At(polygon, ear[1]);
  const Eigen::Vector2f& c = At(polygon, ear[2]);
  if (Cross(a, b, c) <= 0) return false;
  for (const int i : left) {
    if (i == ear[0] || i == ear[1] || i == ear[2]) continue;
    const Eigen::Vector2f& p = At(polygon, i);
    if (Cross(a, b, p) >= 0 && Cross(b, c, p) >= 0 && Cross(c, a, p) >= 0) return false;
  }
  return true;
}

// Triangles over the corners of a simple polygon, by cutting off ears.
std::vector<Triangle> Triangulate(const Polygon& polygon) {
  std::vector<int> left(polygon.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
  std::vector<Triangle> triangles;
  while (left.size() > 3) {
    std::size_t cut = 0;  // a polygon that is not simple loses its first corner
    for (std::size_t i = 0; i < left.size(); ++i) {
      const Triangle ear = {left[(i + left.size() - 1) % left.size()], left[i],
                            left[(i + 1) % left.size()]};
      if (!IsEar(polygon, left, ear)) continue;
      cut = i;
      break;
    }
    triangles.push_back(
        {left[(cut + left.size() - 1) % left.size()], left[cut], left[(cut + 1) % left.size()]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(cut));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

// The walls over a loop of `n` corners: vertices bottom + k and top + k.
void AppendWalls(TriangleMesh& mesh, int bottom, int top, int n, bool outward) {
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    Triangle lower = {bottom + k, bottom + next, top + next};
    Triangle upper = {bottom + k, top + next, top + k};
    if (!outward) {
      std::swap(lower[1], lower[2]);
      std::swap(upper[1], upper[2]);
    }
    mesh.triangles.push_back(lower);
    mesh.triangles.push_back(upper);
  }
}

void AppendLoop(TriangleMesh& mesh, const Polygon& loop, float z) {
  for (const Eigen::Vector2f& p : loop) mesh.vertices.emplace_back(p.x(), p.y(), z);
}

// (x, y, z) -> (z, x, y), a rotation: the z axis becomes x.
TriangleMesh Cycled(TriangleMesh mesh) {
  for (Eigen::Vector3f& v : mesh.vertices) v = Eigen::Vector3f(v.z(), v.x(), v.y());
  return mesh;
}

}  // namespace

Polygon RegularPolygon(const Eigen::Vector2f& center, float radius, int sides, float first_rad) {
  Polygon polygon;
  for (int k = 0; k < sides; ++k) {
    const double turn = first_rad + 2 * std::numbers::pi * k / sides;
    polygon.push_back(center +
                      radius * Eigen::Vector2d(std::cos(turn), std::sin(turn)).cast<float>());
  }
  return polygon;
}

TriangleMesh BoxSolid(const Eigen::Vector3f& min, const Eigen::Vector3f& max) {
  return ExtrudeUp({{min.x(), min.y()}, {max.x(), min.y()}, {max.x(), max.y()}, {min.x(), max.y()}},
                   min.z(), max.z());
}

TriangleMesh ExtrudeUp(const Polygon& polygon, float z0, float z1) {
  const auto n = static_cast<int>(polygon.size());
  TriangleMesh mesh;
  AppendLoop(mesh, polygon, z0);
  AppendLoop(mesh, polygon, z1);
  for (const Triangle& t : Triangulate(polygon)) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({n + t[0], n + t[1], n + t[2]});
  }
  AppendWalls(mesh, 0, n, n, true);
  return mesh;
}

TriangleMesh ExtrudeAlongX(const Polygon& profile, float x0, float x1) {
  return Cycled(ExtrudeUp(profile, x0, x1));
}

TriangleMesh ExtrudeAlongY(const Polygon& profile, float y0, float y1) {
  // Two permutations put the height along y and the profile into (z, x), so the profile's x and z
  // are swapped first, which reverses its orientation.
  Polygon swapped;
  for (auto p = profile.rbegin(); p != profile.rend(); ++p) swapped.emplace_back(p->y(), p->x());
  return Cycled(Cycled(ExtrudeUp(swapped, y0, y1)));
}

TriangleMesh CylinderSolid(const Eigen::Vector2f& center, float radius, float z0, float z1) {
  return ExtrudeUp(RegularPolygon(center, radius, kCylinderSides, 0), z0, z1);
}

TriangleMesh RingSolid(const Polygon& outer, const Polygon& inner, float height) {
  const auto n = static_cast<int>(outer.size());
  TriangleMesh mesh;
  AppendLoop(mesh, outer, 0);
  AppendLoop(mesh, outer, height);
  AppendLoop(mesh, inner, 0);
  AppendLoop(mesh, inner, height);
  AppendWalls(mesh, 0, n, n, true);
  AppendWalls(mesh, 2 * n, 3 * n, n, false);
  AppendWalls(mesh, n, 3 * n, n, true);  // the upper face, from the outer loop to the inner
  AppendWalls(mesh, 0, 2 * n, n, false);
  return mesh;
}

void Append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

TriangleMesh Union(const std::vector<TriangleMesh>& shells) {
  TriangleMesh mesh;
  for (const TriangleMesh& shell : shells) Append(mesh, shell);
  return mesh;
}

TriangleMesh MirroredX(const TriangleMesh& mesh) {
  TriangleMesh mirrored = mesh;
  for (Eigen::Vector3f& v : mirrored.vertices) v.x() = -v.x();
  for (Triangle& t : mirrored.triangles) std::swap(t[1], t[2]);
  return mirrored;
}

}  // namespace graspdb::rendering
