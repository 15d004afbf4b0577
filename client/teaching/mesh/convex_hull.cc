#include "client/teaching/mesh/convex_hull.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;
using Side = std::pair<int, int>;

// Neighbours whose normals differ less are one facet, rad.
constexpr double kCoplanarRad = 2e-4;

struct Triangles {
  std::vector<Triangle> corners;  // positions among the input points of Qhull
  std::vector<Vector3d> normals;
};

// Owns Qhull, its memory and its error output.
class Run {
 public:
  Run() : errors_(open_memstream(&text_, &size_)) { qh_zero(&qhull_, errors_); }
  ~Run() {
    qh_freeqhull(&qhull_, !qh_ALL);
    int kept = 0;
    int bytes = 0;
    qh_memfreeshort(&qhull_, &kept, &bytes);
    if (errors_ != nullptr) std::fclose(errors_);
    std::free(text_);
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  absl::StatusOr<Triangles> Of(std::vector<double> coordinates) {
    if (errors_ == nullptr) return absl::ResourceExhaustedError("no memory for a convex hull");
    const int count = static_cast<int>(coordinates.size() / 3);
    std::string options = "qhull Qt";  // triangles
    const int failed = qh_new_qhull(&qhull_, 3, count, coordinates.data(), False, options.data(),
                                    nullptr, errors_);
    if (failed != 0) return Failure();
    return Collect(coordinates);
  }

 private:
  absl::Status Failure() {
    std::fflush(errors_);
    std::string reason(text_, size_);
    reason.resize(std::min(reason.size(), reason.find('\n')));  // the other lines are a manual
    return absl::InvalidArgumentError(absl::StrCat(
        "the mesh has no convex hull, as when it is flat (", reason, "); give it a thickness"));
  }

  // Counter-clockwise seen from outside.
  Triangles Collect(const std::vector<double>& coordinates) {
    const auto at = [&](int i) {
      return Vector3d::Map(coordinates.data() + std::ptrdiff_t{3} * i);
    };
    Triangles out;
    qhT* const qh = &qhull_;  // the macros require this name
    facetT* facet = nullptr;
    FORALLfacets {
      Triangle t{};
      for (int k = 0; k < 3; ++k) {
        const auto* corner = static_cast<vertexT*>(facet->vertices->e[k].p);
        t[static_cast<std::size_t>(k)] = qh_pointid(qh, corner->point);
      }
      const Vector3d normal = Vector3d::Map(facet->normal);
      if ((at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).dot(normal) < 0) std::swap(t[1], t[2]);
      out.corners.push_back(t);
      out.normals.push_back(normal);
    }
    return out;
  }

  qhT qhull_;
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* errors_;
};

std::map<Side, int> TriangleOfSide(const std::vector<Triangle>& triangles) {
  std::map<Side, int> out;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      out[{triangles[i][k], triangles[i][(k + 1) % 3]}] = static_cast<int>(i);
    }
  }
  return out;
}

// For every triangle a number, the same for those in one plane; numbers from 0 without gaps.
std::vector<int> PlaneOfTriangle(const Triangles& hull, const std::map<Side, int>& of_side) {
  std::vector<int> parent(hull.corners.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[static_cast<std::size_t>(i)] != i) i = parent[static_cast<std::size_t>(i)];
    return i;
  };
  for (const auto& [side, i] : of_side) {
    const auto beyond = of_side.find({side.second, side.first});
    if (beyond == of_side.end()) continue;
    const double sine = hull.normals[static_cast<std::size_t>(i)]
                            .cross(hull.normals[static_cast<std::size_t>(beyond->second)])
                            .norm();
    const int a = root(i);
    const int b = root(beyond->second);
    if (sine < kCoplanarRad) parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  std::vector<int> plane(parent.size());
  std::map<int, int> number;
  for (std::size_t i = 0; i < parent.size(); ++i) {
    const int top = root(static_cast<int>(i));
    plane[i] = number.emplace(top, static_cast<int>(number.size())).first->second;
  }
  return plane;
}

// The mean plane of its triangles, by their areas, through its outermost corner.
void FitPlane(const std::vector<Vector3d>& points, HullFacet* facet) {
  const auto at = [&](int i) -> const Vector3d& { return points[static_cast<std::size_t>(i)]; };
  Vector3d area = Vector3d::Zero();
  for (const Triangle& t : facet->triangles) {
    area += (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
  }
  if (area.norm() > 0) facet->normal = area.normalized();
  facet->offset_m = facet->normal.dot(at(facet->triangles.front()[0]));
  for (const Triangle& t : facet->triangles) {
    for (const int corner : t) {
      facet->offset_m = std::max(facet->offset_m, facet->normal.dot(at(corner)));
    }
  }
}

ConvexHull Assemble(const std::vector<double>& coordinates, const Triangles& from) {
  const std::map<Side, int> of_side = TriangleOfSide(from.corners);
  const std::vector<int> plane = PlaneOfTriangle(from, of_side);
  ConvexHull out;
  out.facets.resize(static_cast<std::size_t>(*std::ranges::max_element(plane)) + 1);
  std::map<int, int> corner;  // position in `points` of a point of Qhull's
  const auto moved = [&](int i) {
    const auto [found, is_new] = corner.emplace(i, static_cast<int>(out.points.size()));
    if (is_new) out.points.emplace_back(coordinates.data() + std::ptrdiff_t{3} * i);
    return found->second;
  };
  for (std::size_t i = 0; i < from.corners.size(); ++i) {
    const Triangle& t = from.corners[i];
    HullFacet& facet = out.facets[static_cast<std::size_t>(plane[i])];
    facet.normal = from.normals[i];
    facet.triangles.push_back({moved(t[0]), moved(t[1]), moved(t[2])});
    for (std::size_t k = 0; k < 3; ++k) {
      const Side side(t[k], t[(k + 1) % 3]);
      const auto beyond = of_side.find({side.second, side.first});
      if (beyond == of_side.end()) continue;
      const int neighbor = plane[static_cast<std::size_t>(beyond->second)];
      if (neighbor == plane[i]) continue;
      facet.edges.push_back({moved(side.first), moved(side.second), neighbor});
    }
  }
  for (HullFacet& facet : out.facets) FitPlane(out.points, &facet);
  return out;
}

}  // namespace

absl::StatusOr<ConvexHull> HullOf(const std::vector<Eigen::Vector3f>& points) {
  std::vector<double> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Eigen::Vector3f& p : points) {
    if (!p.allFinite()) return absl::InvalidArgumentError("a point of the mesh is not finite");
    for (const float c : p) coordinates.push_back(static_cast<double>(c));
  }
  if (points.size() < 4) {
    return absl::InvalidArgumentError(
        "the mesh has no volume; give one with at least four corners");
  }
  ASSIGN_OR_RETURN(const Triangles triangles, Run().Of(coordinates));
  return Assemble(coordinates, triangles);
}

HullMass MassOf(const ConvexHull& hull) {
  HullMass out;
  if (hull.points.empty()) return out;
  Vector3d apex = Vector3d::Zero();
  for (const Vector3d& p : hull.points) apex += p / static_cast<double>(hull.points.size());
  Vector3d moment = Vector3d::Zero();
  for (const HullFacet& facet : hull.facets) {
    for (const Triangle& t : facet.triangles) {
      const Vector3d a = hull.points[static_cast<std::size_t>(t[0])] - apex;
      const Vector3d b = hull.points[static_cast<std::size_t>(t[1])] - apex;
      const Vector3d c = hull.points[static_cast<std::size_t>(t[2])] - apex;
      const double part = a.dot(b.cross(c)) / 6;
      out.volume_m3 += part;
      moment += part * (a + b + c) / 4;
    }
  }
  out.center = apex + moment / std::max(out.volume_m3, 1e-30);
  return out;
}

}  // namespace graspdb::client
