#include "rendering/meshes/mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "rendering/random/counter_random.h"

namespace graspdb::rendering {
namespace {

constexpr std::size_t kExactDiameterVertices = 4096;
constexpr int kSupportDirections = 1024;

// The vertices furthest out in many directions.
std::vector<Eigen::Vector3f> SupportPoints(const std::vector<Eigen::Vector3f>& vertices) {
  std::vector<Eigen::Vector3f> support;
  for (int i = 0; i < kSupportDirections; ++i) {
    const Eigen::Vector3f d = EvenDirection(i, kSupportDirections);
    support.push_back(*std::max_element(
        vertices.begin(), vertices.end(),
        [&d](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return d.dot(a) < d.dot(b); }));
  }
  return support;
}

struct Corners {
  Eigen::Vector3d a, b, c;
};

Corners CornersOf(const TriangleMesh& mesh, const std::array<int, 3>& t) {
  const auto at = [&mesh](int i) -> Eigen::Vector3d {
    return mesh.vertices[static_cast<std::size_t>(i)].cast<double>();
  };
  return {at(t[0]), at(t[1]), at(t[2])};
}

double AreaOf(const Corners& k) { return (k.b - k.a).cross(k.c - k.a).norm() / 2; }

}  // namespace

Eigen::Vector3f EvenDirection(int i, int count) {
  const double z = 1 - (2.0 * i + 1) / count;
  const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
  const double r = std::sqrt(1 - z * z);
  return Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z).cast<float>();
}

absl::Status CheckMesh(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return absl::InvalidArgumentError("the mesh has no triangles");
  for (const Eigen::Vector3f& v : mesh.vertices) {
    if (!v.allFinite())
      return absl::InvalidArgumentError("the mesh has a vertex that is not finite");
  }
  const auto count = static_cast<int>(mesh.vertices.size());
  for (const std::array<int, 3>& t : mesh.triangles) {
    const auto [low, high] = std::minmax({t[0], t[1], t[2]});
    if (low < 0 || high >= count) {
      return absl::InvalidArgumentError(
          absl::StrCat("the mesh has a triangle with a corner beyond its ", count, " vertices"));
    }
  }
  return absl::OkStatus();
}

recognition::Box BoundsOf(const TriangleMesh& mesh) {
  recognition::Box box;
  if (mesh.vertices.empty()) return box;
  box.min = box.max = mesh.vertices.front().cast<double>();
  for (const Eigen::Vector3f& v : mesh.vertices) {
    box.min = box.min.cwiseMin(v.cast<double>());
    box.max = box.max.cwiseMax(v.cast<double>());
  }
  return box;
}

double DiameterOf(const TriangleMesh& mesh) {
  const std::vector<Eigen::Vector3f> points =
      mesh.vertices.size() > kExactDiameterVertices ? SupportPoints(mesh.vertices) : mesh.vertices;
  float largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      largest = std::max(largest, (points[i] - points[j]).squaredNorm());
    }
  }
  return std::sqrt(static_cast<double>(largest));
}

double AreaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const std::array<int, 3>& t : mesh.triangles) area += AreaOf(CornersOf(mesh, t));
  return area;
}

recognition::OrientedCloud SampleOrientedSurface(const TriangleMesh& mesh, int count,
                                                 std::uint64_t seed) {
  std::vector<double> area_up_to;
  double total = 0;
  for (const std::array<int, 3>& t : mesh.triangles) {
    total += AreaOf(CornersOf(mesh, t));
    area_up_to.push_back(total);
  }
  recognition::OrientedCloud out;
  if (!(total > 0)) return out;
  for (int i = 0; i < count; ++i) {
    const auto n = static_cast<std::uint64_t>(i);
    const double at = RandomUniform(seed, 0, n) * total;
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end(), at);
    const auto index =
        std::min<std::ptrdiff_t>(found - area_up_to.begin(), std::ssize(area_up_to) - 1);
    const Corners k = CornersOf(mesh, mesh.triangles[static_cast<std::size_t>(index)]);
    // Uniform on a triangle, Osada et al. 2002, eq. 1.
    const double r = std::sqrt(RandomUniform(seed, 1, n));
    const double s = RandomUniform(seed, 2, n);
    const Eigen::Vector3d p = (1 - r) * k.a + r * (1 - s) * k.b + r * s * k.c;
    out.points.push_back(p.cast<float>());
    out.normals.push_back((k.b - k.a).cross(k.c - k.a).normalized().cast<float>());
  }
  return out;
}

recognition::Points SampleSurface(const TriangleMesh& mesh, int count, std::uint64_t seed) {
  return SampleOrientedSurface(mesh, count, seed).points;
}

absl::StatusOr<Eigen::Vector3d> CenterOfMass(const TriangleMesh& mesh) {
  // The solid is the signed sum of the tetrahedra over its triangles.
  const recognition::Box box = BoundsOf(mesh);
  const Eigen::Vector3d apex = (box.min + box.max) / 2;
  double volume = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const std::array<int, 3>& t : mesh.triangles) {
    const Corners k = CornersOf(mesh, t);
    const double part = (k.a - apex).dot((k.b - apex).cross(k.c - apex)) / 6;
    volume += part;
    moment += part * (k.a + k.b + k.c - 3 * apex) / 4;
  }
  if (!(std::abs(volume) > 1e-6 * (box.max - box.min).prod())) {
    return absl::FailedPreconditionError("the mesh encloses no volume; close its surface");
  }
  return Eigen::Vector3d(apex + moment / volume);
}

TriangleMesh Transformed(const TriangleMesh& mesh, const recognition::Pose& pose) {
  TriangleMesh moved = mesh;
  for (Eigen::Vector3f& v : moved.vertices) v = (pose * v.cast<double>()).cast<float>();
  return moved;
}

}  // namespace graspdb::rendering
