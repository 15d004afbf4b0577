#include "client/teaching/mesh/resting.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "absl/status/status.h"

namespace graspdb::client {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A closed surface's areas sum to zero as vectors; holes up to this share of its area are small.
constexpr double kOpenShare = 0.01;
// Volumes outside these shares of the hull's are not those of a solid: faces are inverted, or
// shells are nested.
constexpr double kMinVolume = 1e-3;
constexpr double kMaxVolume = 1.01;
// A facet is not stable if a smaller tilt makes the object roll downhill.
constexpr double kMinTip = 0.017455;  // the tangent of one degree

std::size_t At(int i) { return static_cast<std::size_t>(i); }

// Share of the sphere around `eye` that a triangle covers (A. van Oosterom and J. Strackee, "The
// solid angle of a plane triangle", 1983).
double SolidAngle(const Vector3d& eye, const Vector3d& p, const Vector3d& q, const Vector3d& r) {
  const Vector3d a = p - eye;
  const Vector3d b = q - eye;
  const Vector3d c = r - eye;
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  const double over = a.dot(b.cross(c));
  const double under = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
  return 2 * std::atan2(over, under);
}

// A hull with the height of the centre of mass over each facet.
class Landscape {
 public:
  Landscape(const ConvexHull& hull, const Vector3d& center) : hull_(hull), center_(center) {
    heights_.reserve(hull.facets.size());
    for (const HullFacet& f : hull.facets) heights_.push_back(f.offset_m - f.normal.dot(center));
  }

  double height(int facet) const { return heights_[At(facet)]; }

  double SolidAngleOf(int facet) const {
    double sum = 0;
    for (const auto& t : hull_.facets[At(facet)].triangles) {
      sum += SolidAngle(center_, hull_.points[At(t[0])], hull_.points[At(t[1])],
                        hull_.points[At(t[2])]);
    }
    return sum;
  }

  // The facet to which it rolls from `facet`; `facet` itself if it rests there.
  int Next(int facet) const {
    const HullFacet& f = hull_.facets[At(facet)];
    const Vector3d foot = center_ + height(facet) * f.normal;  // below the centre of mass
    double nearest = std::numeric_limits<double>::infinity();
    int next = facet;
    for (const HullFacet::Edge& edge : f.edges) {
      const Vector3d& a = hull_.points[At(edge.from)];
      const Vector3d along = hull_.points[At(edge.to)] - a;
      const double inside = f.normal.cross(along).normalized().dot(foot - a);
      if (inside >= kMinTip * height(facet) || height(edge.neighbor) >= height(facet)) continue;
      const double t = std::clamp(along.dot(foot - a) / along.squaredNorm(), 0.0, 1.0);
      const double distance = (a + t * along - foot).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      next = edge.neighbor;
    }
    return next;
  }

  // The maximum height while it rolls over an edge.
  double PassOver(int facet, const HullFacet::Edge& edge) const {
    const double higher = std::max(height(facet), height(edge.neighbor));
    const Vector3d& a = hull_.points[At(edge.from)];
    const Vector3d along = (hull_.points[At(edge.to)] - a).normalized();
    Vector3d arm = a - center_;  // from the centre of mass square to the edge
    arm -= along.dot(arm) * along;
    // It passes over the edge where "down" points along the arm between both facets' normals.
    const Vector3d& from = hull_.facets[At(facet)].normal;
    const Vector3d& to = hull_.facets[At(edge.neighbor)].normal;
    const bool between = from.cross(arm).dot(from.cross(to)) >= 0 &&
                         to.cross(arm).dot(to.cross(from)) >= 0 && arm.dot(from + to) > 0;
    return between ? arm.norm() : higher;
  }

 private:
  const ConvexHull& hull_;
  Vector3d center_;
  std::vector<double> heights_;
};

// Facets joined from the lowest pass upwards, for as long as a basin is shallower than the lift:
// the persistence of its lowest point.
class Basins {
 public:
  Basins(const ConvexHull& hull, const Landscape& land, double roll_lift_m) {
    parent_.resize(hull.facets.size());
    std::iota(parent_.begin(), parent_.end(), 0);
    struct Pass {
      double height;
      int a, b;
    };
    std::vector<Pass> passes;
    for (int f = 0; f < static_cast<int>(hull.facets.size()); ++f) {
      lowest_.push_back(land.height(f));
      for (const HullFacet::Edge& edge : hull.facets[At(f)].edges) {
        if (edge.neighbor > f) passes.push_back({land.PassOver(f, edge), f, edge.neighbor});
      }
    }
    std::ranges::stable_sort(passes, {}, &Pass::height);
    for (const Pass& pass : passes) {
      int a = Of(pass.a);
      int b = Of(pass.b);
      if (a == b) continue;
      if (lowest_[At(b)] < lowest_[At(a)]) std::swap(a, b);
      if (pass.height - lowest_[At(b)] <= roll_lift_m) parent_[At(b)] = a;
    }
  }

  int Of(int facet) const {
    while (parent_[At(facet)] != facet) facet = parent_[At(facet)];
    return facet;
  }

 private:
  std::vector<int> parent_;
  std::vector<double> lowest_;
};

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Counter-clockwise (A. M. Andrew, "Another efficient algorithm for convex hulls in two
// dimensions", 1979).
std::vector<Vector2d> Polygon(std::vector<Vector2d> points) {
  std::ranges::sort(points, [](const Vector2d& a, const Vector2d& b) {
    return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
  });
  std::vector<Vector2d> out;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t begin = out.size();
    for (const Vector2d& p : points) {
      while (out.size() >= begin + 2 &&
             Cross(out.back() - out[out.size() - 2], p - out[out.size() - 2]) <= 0) {
        out.pop_back();
      }
      out.push_back(p);
    }
    out.pop_back();
    std::ranges::reverse(points);
  }
  return out;
}

bool IsInside(const ConvexHull& hull, const Vector3d& p) {
  return std::ranges::all_of(hull.facets,
                             [&](const HullFacet& f) { return f.normal.dot(p) < f.offset_m; });
}

}  // namespace

MassCenter CenterOfMass(const rendering::TriangleMesh& mesh, const ConvexHull& hull) {
  const HullMass whole = MassOf(hull);
  Vector3d open = Vector3d::Zero();
  double area = 0;
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d p = mesh.vertices[At(a)].cast<double>() - whole.center;
    const Vector3d q = mesh.vertices[At(b)].cast<double>() - whole.center;
    const Vector3d r = mesh.vertices[At(c)].cast<double>() - whole.center;
    const Vector3d twice = (q - p).cross(r - p);
    open += twice / 2;
    area += twice.norm() / 2;
    volume += p.dot(q.cross(r)) / 6;
  }
  const double share = std::abs(volume) / whole.volume_m3;
  const absl::StatusOr<Vector3d> solid = rendering::CenterOfMass(mesh);
  const bool is_solid = solid.ok() && open.norm() <= kOpenShare * area && share >= kMinVolume &&
                        share <= kMaxVolume && IsInside(hull, *solid);
  return is_solid ? MassCenter{*solid, false} : MassCenter{whole.center, true};
}

absl::StatusOr<std::vector<RestingFacet>> RestingFacets(const ConvexHull& hull,
                                                        const Vector3d& center,
                                                        double roll_lift_m) {
  if (!IsInside(hull, center)) {
    return absl::FailedPreconditionError(
        "the centre of mass lies outside of the hull; close the surface of the mesh");
  }
  const Landscape land(hull, center);
  const Basins basins(hull, land, roll_lift_m);
  const int count = static_cast<int>(hull.facets.size());
  std::vector<double> probability(At(count));
  for (int f = 0; f < count; ++f) {
    int at = f;
    for (int next = land.Next(at); next != at; next = land.Next(at)) at = next;
    probability[At(at)] += land.SolidAngleOf(f) / (4 * std::numbers::pi);
  }
  std::vector<RestingFacet> out;
  for (int f = 0; f < count; ++f) {
    if (!(probability[At(f)] > 0)) continue;
    out.push_back({f, hull.facets[At(f)].normal, probability[At(f)], basins.Of(f)});
  }
  std::ranges::stable_sort(out, std::greater(), &RestingFacet::probability);
  return out;
}

double TipAngle(const ConvexHull& hull, const Vector3d& center, const Vector3d& down,
                double touching_m) {
  const Vector3d x = down.unitOrthogonal();
  const Vector3d y = down.cross(x);
  double lowest = -std::numeric_limits<double>::infinity();
  for (const Vector3d& p : hull.points) lowest = std::max(lowest, down.dot(p - center));
  std::vector<Vector2d> touching;
  for (const Vector3d& p : hull.points) {
    if (down.dot(p - center) < lowest - touching_m) continue;
    touching.emplace_back(x.dot(p - center), y.dot(p - center));
  }
  const std::vector<Vector2d> polygon = Polygon(std::move(touching));
  if (polygon.size() < 3) return 0;
  double margin = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d along = (polygon[(i + 1) % polygon.size()] - polygon[i]).normalized();
    margin = std::min(margin, Cross(along, -polygon[i]));
  }
  return std::atan2(margin, lowest);
}

}  // namespace graspdb::client
