#include "client/teaching/mesh/even_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace graspdb::client {
namespace {

using Eigen::Vector3d;

// An axis is preferred to a later one of the same size, whatever the rounding.
constexpr double kEqualAxes = 1 + 1e-3;
// Of the box around the mesh: a triangle crosses at most as many rows as that.
constexpr double kMaxLines = 1000;
// Of the spacing, from the corner of the box to the first line: no fraction of a symmetric part.
constexpr double kFirstLine = 0.381966;

Eigen::Index MainAxisOf(const Vector3d& normal) {
  const Vector3d size = normal.cwiseAbs();
  Eigen::Index axis = 0;
  for (const Eigen::Index other : {1, 2}) {
    if (size[other] > size[axis] * kEqualAxes) axis = other;
  }
  return axis;
}

class Grid {
 public:
  Grid(const recognition::Box& box, double spacing)
      : first_(box.min - Vector3d::Constant(kFirstLine * spacing)), spacing_(spacing) {}

  double spacing() const { return spacing_; }
  double Line(Eigen::Index axis, int i) const { return first_[axis] + i * spacing_; }
  // The first line at `x` or beyond.
  int From(Eigen::Index axis, double x) const {
    return static_cast<int>(std::ceil((x - first_[axis]) / spacing_));
  }

 private:
  Vector3d first_;
  double spacing_;
};

// Where the side from `a` to `b` crosses the row `v`, lower end included and upper end not, so that
// triangles that share a side share no point; false if it does not.
bool Crosses(Vector3d a, Vector3d b, Eigen::Index u_axis, Eigen::Index v_axis, double v,
             double* u) {
  if (a[v_axis] > b[v_axis]) std::swap(a, b);
  if (v < a[v_axis] || v >= b[v_axis]) return false;
  const double share = (v - a[v_axis]) / (b[v_axis] - a[v_axis]);
  *u = a[u_axis] + share * (b[u_axis] - a[u_axis]);
  return true;
}

void AppendTriangle(const std::array<Vector3d, 3>& corners, const Grid& grid,
                    std::size_t max_points, EvenSamples& out) {
  const Vector3d across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(across.norm() > 0)) return;
  const Vector3d normal = across.normalized();
  const Eigen::Index axis = MainAxisOf(normal);
  const Eigen::Index u_axis = (axis + 1) % 3;
  const Eigen::Index v_axis = (axis + 2) % 3;
  const auto [low, high] =
      std::minmax({corners[0][v_axis], corners[1][v_axis], corners[2][v_axis]});
  for (int row = grid.From(v_axis, low); grid.Line(v_axis, row) < high; ++row) {
    const double v = grid.Line(v_axis, row);
    std::array<double, 3> crossings{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      double u = 0;
      if (Crosses(corners[k], corners[(k + 1) % 3], u_axis, v_axis, v, &u)) crossings[count++] = u;
    }
    if (count != 2) continue;
    const auto [first, last] = std::minmax({crossings[0], crossings[1]});
    for (int column = grid.From(u_axis, first); grid.Line(u_axis, column) < last; ++column) {
      if (out.areas.size() >= max_points) return;
      Vector3d p = corners[0];
      p[u_axis] = grid.Line(u_axis, column);
      p[v_axis] = v;
      p[axis] -= normal.dot(p - corners[0]) / normal[axis];
      out.cloud.points.push_back(p.cast<float>());
      out.cloud.normals.push_back(normal.cast<float>());
      out.areas.push_back(grid.spacing() * grid.spacing() / std::abs(normal[axis]));
    }
  }
}

}  // namespace

EvenSamples SampleEvenly(const rendering::TriangleMesh& mesh, int count) {
  EvenSamples out;
  const std::size_t max_points = 2 * static_cast<std::size_t>(std::max(count, 0));
  const double area = rendering::AreaOf(mesh);
  if (!(area > 0)) return out;
  const recognition::Box box = rendering::BoundsOf(mesh);
  const Grid grid(box,
                  std::max(std::sqrt(area / count), (box.max - box.min).maxCoeff() / kMaxLines));
  for (const std::array<int, 3>& t : mesh.triangles) {
    std::array<Vector3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = mesh.vertices[static_cast<std::size_t>(t[k])].cast<double>();
    }
    AppendTriangle(corners, grid, max_points, out);
  }
  return out;
}

}  // namespace graspdb::client
