#include "rendering/meshes/outward_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace graspdb::rendering {
namespace {

using Eigen::Vector3d;

// Shares of the area that a closed surface leaves open, and of the bounding box that it encloses:
// rounding errors are less.
constexpr double kMaxOpenShare = 1e-3;
constexpr double kMinEnclosedShare = 1e-6;
// Share of the area up to which triangles that turn against the others are taken for mistakes.
constexpr double kMaxMinority = 0.25;
// Containment costs the triangles of both shells each; a part with more shells is no solid.
constexpr std::size_t kMaxNestedShells = 64;

struct Edge {
  std::int64_t ends = 0;  // of both vertices, the same in either direction
  int triangle = 0;
  bool is_forward = false;  // from the lower vertex to the higher one
};

struct Neighbours {
  int a = 0;
  int b = 0;
  bool are_opposed = false;
};

// Triangles that share an edge with each other only.
std::vector<Neighbours> NeighboursIn(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (int i = 0; i < std::ssize(mesh.triangles); ++i) {
    const std::array<int, 3>& t = mesh.triangles[static_cast<std::size_t>(i)];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.push_back({(std::int64_t{low} << 32) + high, i, low == t[k]});
    }
  }
  std::ranges::stable_sort(edges, {}, &Edge::ends);
  std::vector<Neighbours> out;
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end].ends == edges[i].ends) ++end;
    if (end - i != 2) continue;
    out.push_back(
        {edges[i].triangle, edges[i + 1].triangle, edges[i].is_forward == edges[i + 1].is_forward});
  }
  return out;
}

// Disjoint sets of triangles, each with whether it turns against the first one of its set.
class Surfaces {
 public:
  explicit Surfaces(std::size_t count)
      : parent_(count), size_(count, 1), is_turned_(count, false), is_one_sided_(count, false) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  void Join(const Neighbours& pair) {
    auto [a, a_turned] = Find(pair.a);
    auto [b, b_turned] = Find(pair.b);
    const bool is_against = (a_turned != b_turned) != pair.are_opposed;
    if (a == b) {
      if (is_against) is_one_sided_[At(a)] = true;
      return;
    }
    if (size_[At(a)] < size_[At(b)]) std::swap(a, b);
    parent_[At(b)] = a;
    size_[At(a)] += size_[At(b)];
    is_turned_[At(b)] = is_against;
    is_one_sided_[At(a)] = is_one_sided_[At(a)] || is_one_sided_[At(b)];
  }

  // The set's name, and whether `triangle` turns against it.
  std::pair<int, bool> Find(int triangle) const {
    bool turned = false;
    while (parent_[At(triangle)] != triangle) {  // joined by size: at most log n steps
      turned = turned != is_turned_[At(triangle)];
      triangle = parent_[At(triangle)];
    }
    return {triangle, turned};
  }

  bool IsOneSided(int set) const { return is_one_sided_[At(set)]; }

 private:
  static std::size_t At(int i) { return static_cast<std::size_t>(i); }

  std::vector<int> parent_;
  std::vector<int> size_;
  std::vector<bool> is_turned_;
  std::vector<bool> is_one_sided_;
};

// What a set of triangles encloses.
struct Enclosed {
  Vector3d open = Vector3d::Zero();
  double area = 0;
  double volume = 0;
  recognition::Box box;

  bool IsClosed() const {
    const double least = kMinEnclosedShare * (box.max - box.min).prod();
    return open.norm() <= kMaxOpenShare * area && std::abs(volume) > least;
  }
};

using TriangleCorners = std::array<Vector3d, 3>;

TriangleCorners CornersAt(const TriangleMesh& mesh, int triangle) {
  const std::array<int, 3>& t = mesh.triangles[static_cast<std::size_t>(triangle)];
  const auto at = [&](int i) -> Vector3d {
    return mesh.vertices[static_cast<std::size_t>(i)].cast<double>();
  };
  return {at(t[0]), at(t[1]), at(t[2])};
}

double AreaIn(const TriangleMesh& mesh, int triangle) {
  const auto [a, b, c] = CornersAt(mesh, triangle);
  return (b - a).cross(c - a).norm() / 2;
}

Enclosed EnclosedBy(const TriangleMesh& mesh, const std::vector<int>& triangles) {
  Enclosed out;
  out.box.min = out.box.max = CornersAt(mesh, triangles.front())[0];
  for (const int i : triangles) {
    for (const Vector3d& corner : CornersAt(mesh, i)) {
      out.box.min = out.box.min.cwiseMin(corner);
      out.box.max = out.box.max.cwiseMax(corner);
    }
  }
  const Vector3d middle = (out.box.min + out.box.max) / 2;
  for (const int i : triangles) {
    const auto [a, b, c] = CornersAt(mesh, i);
    const Vector3d normal = (b - a).cross(c - a) / 2;
    out.open += normal;
    out.area += normal.norm();
    out.volume += (a - middle).dot((b - middle).cross(c - middle)) / 6;
  }
  return out;
}

void Turn(TriangleMesh& mesh, const std::vector<int>& triangles) {
  for (const int i : triangles) {
    std::array<int, 3>& t = mesh.triangles[static_cast<std::size_t>(i)];
    std::swap(t[1], t[2]);
  }
}

// A closed surface whose triangles turn alike.
struct Shell {
  std::vector<int> triangles;
  Enclosed enclosed;
  bool is_clear = false;  // most triangles turned alike in the file
  bool is_outwards = false;
};

// Whether the point is inside, by the sum of the solid angles of the triangles (A. van Oosterom and
// J. Strackee, "The solid angle of a plane triangle", 1983).
bool IsInside(const TriangleMesh& mesh, const Shell& shell, const Vector3d& eye) {
  double sum = 0;
  for (const int i : shell.triangles) {
    const auto corners = CornersAt(mesh, i);
    const Vector3d a = corners[0] - eye;
    const Vector3d b = corners[1] - eye;
    const Vector3d c = corners[2] - eye;
    sum += 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                 a.dot(c) * b.norm() + b.dot(c) * a.norm());
  }
  return std::abs(sum) > 2 * std::numbers::pi;
}

bool Contains(const TriangleMesh& mesh, const Shell& outer, const Shell& inner) {
  const recognition::Box& a = outer.enclosed.box;
  const recognition::Box& b = inner.enclosed.box;
  if ((a.min.array() >= b.min.array()).any() || (a.max.array() <= b.max.array()).any()) {
    return false;
  }
  for (const int i : {inner.triangles.front(), inner.triangles[inner.triangles.size() / 2]}) {
    if (!IsInside(mesh, outer, CornersAt(mesh, i)[0])) return false;
  }
  return true;
}

// Whether each of `shells`, the largest first, is to turn outwards.
std::vector<bool> Outwards(const TriangleMesh& mesh, const std::vector<Shell>& shells) {
  std::vector<bool> out(shells.size(), true);
  if (shells.size() > kMaxNestedShells) {
    const double volume = std::transform_reduce(
        shells.begin(), shells.end(), 0.0, std::plus(),
        [](const Shell& shell) { return shell.is_clear ? shell.enclosed.volume : 0; });
    for (std::size_t i = 0; i < shells.size(); ++i) {
      if (shells[i].is_clear) out[i] = shells[i].is_outwards == (volume >= 0);
    }
    return out;
  }
  for (std::size_t i = 0; i < shells.size(); ++i) {
    for (std::size_t k = i; k-- > 0;) {  // the smallest one around it first
      if (!Contains(mesh, shells[k], shells[i])) continue;
      const bool is_alike = shells[k].is_clear && shells[i].is_clear &&
                            shells[k].is_outwards == shells[i].is_outwards;
      out[i] = is_alike == out[k];
      break;
    }
  }
  return out;
}

std::vector<std::vector<int>> SetsOf(const TriangleMesh& mesh, const Surfaces& surfaces) {
  std::vector<std::pair<int, int>> named;
  named.reserve(mesh.triangles.size());
  for (int i = 0; i < std::ssize(mesh.triangles); ++i)
    named.emplace_back(surfaces.Find(i).first, i);
  std::ranges::sort(named);
  std::vector<std::vector<int>> out;
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (i == 0 || named[i].first != named[i - 1].first) out.emplace_back();
    out.back().push_back(named[i].second);
  }
  return out;
}

// The triangles that turn against the others of their surface, the smaller part by area.
struct Minority {
  std::vector<int> triangles;
  bool is_small = false;
};

Minority MinorityOf(const TriangleMesh& mesh, const Surfaces& surfaces,
                    const std::vector<int>& triangles) {
  std::array<std::vector<int>, 2> sides;
  std::array<double, 2> areas = {0, 0};
  for (const int i : triangles) {
    const std::size_t side = surfaces.Find(i).second ? 1 : 0;
    sides[side].push_back(i);
    areas[side] += AreaIn(mesh, i);
  }
  const std::size_t fewer = areas[1] <= areas[0] ? 1 : 0;
  return {std::move(sides[fewer]), areas[fewer] <= kMaxMinority * (areas[0] + areas[1])};
}

struct SidedTriangle {
  std::array<int, 3> corners{};  // in order
  bool is_turned = false;        // they follow each other the other way round
  std::size_t place = 0;
};

SidedTriangle Sided(std::array<int, 3> triangle, std::size_t place) {
  std::rotate(triangle.begin(), std::ranges::min_element(triangle), triangle.end());
  const bool is_turned = triangle[1] > triangle[2];
  if (is_turned) std::swap(triangle[1], triangle[2]);
  return {triangle, is_turned, place};
}

}  // namespace

void TurnOutwards(TriangleMesh& mesh) {
  Surfaces surfaces(mesh.triangles.size());
  for (const Neighbours& pair : NeighboursIn(mesh)) surfaces.Join(pair);
  std::vector<Shell> shells;
  std::vector<int> others;
  for (std::vector<int>& triangles : SetsOf(mesh, surfaces)) {
    if (surfaces.IsOneSided(surfaces.Find(triangles.front()).first)) continue;
    const Minority minority = MinorityOf(mesh, surfaces, triangles);
    Turn(mesh, minority.triangles);
    const Enclosed enclosed = EnclosedBy(mesh, triangles);
    if (enclosed.IsClosed()) {
      shells.push_back({std::move(triangles), enclosed, minority.is_small, enclosed.volume > 0});
      continue;
    }
    if (!minority.is_small) Turn(mesh, minority.triangles);  // back
    others.insert(others.end(), triangles.begin(), triangles.end());
  }
  std::ranges::stable_sort(shells, std::greater(), [](const Shell& shell) {
    return (shell.enclosed.box.max - shell.enclosed.box.min).prod();
  });
  const std::vector<bool> outwards = Outwards(mesh, shells);
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (outwards[i] != shells[i].is_outwards) Turn(mesh, shells[i].triangles);
  }
  // Surfaces that close with each other only, as where the corners of one lie on edges of another.
  if (others.empty()) return;
  const Enclosed rest = EnclosedBy(mesh, others);
  if (rest.IsClosed() && rest.volume < 0) Turn(mesh, others);
}

double OpposedShare(const TriangleMesh& mesh) {
  const std::vector<Neighbours> pairs = NeighboursIn(mesh);
  if (pairs.empty()) return 0;
  const auto opposed = std::ranges::count_if(pairs, &Neighbours::are_opposed);
  return static_cast<double>(opposed) / static_cast<double>(pairs.size());
}

void RemoveRepeated(TriangleMesh& mesh) {
  std::vector<SidedTriangle> all;
  all.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    all.push_back(Sided(mesh.triangles[i], i));
  }
  std::ranges::sort(all, {}, [](const SidedTriangle& one) {
    return std::tuple(one.corners, one.is_turned, one.place);
  });
  const auto is_same = [](const SidedTriangle& a, const SidedTriangle& b) {
    return a.corners == b.corners && a.is_turned == b.is_turned;
  };
  all.erase(std::unique(all.begin(), all.end(), is_same), all.end());
  std::ranges::sort(all, {},
                    [](const SidedTriangle& one) { return std::pair(one.corners, one.place); });
  std::vector<SidedTriangle> one_side;
  std::ranges::unique_copy(all, std::back_inserter(one_side), {}, &SidedTriangle::corners);
  if (all.size() == 2 * one_side.size()) all = std::move(one_side);
  std::ranges::sort(all, {}, &SidedTriangle::place);
  std::vector<std::array<int, 3>> kept;
  kept.reserve(all.size());
  for (const SidedTriangle& one : all) kept.push_back(mesh.triangles[one.place]);
  mesh.triangles = std::move(kept);
}

}  // namespace graspdb::rendering
