#include "client/cell/calibration/target/orientations.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "recognition/verification/visibility.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3f;

// Directions on a whole sphere: neighbours are eleven degrees apart.
constexpr int kCameraDirections = 300;
// Sine of the lowest look-down angle: gripped objects are seen slightly from below.
constexpr double kLowestSine = -0.2;
// Far enough to see the whole side, m.
constexpr float kCameraDistanceM = 0.7F;
constexpr std::size_t kPoints = 60;
// A prime above kPoints, so that no point of a side is taken twice; of 60 points every 37th.
constexpr std::size_t kPointStep = 877;
constexpr std::size_t kAnchors = 4;

// Indices by farthest point sampling, the first nearest to the mean.
std::vector<std::size_t> FarApart(const recognition::Points& points) {
  Vector3f mean = Vector3f::Zero();
  for (const Vector3f& p : points) mean += p;
  mean /= static_cast<float>(points.size());
  std::vector<std::size_t> out;
  std::vector<float> nearest(points.size(), 1e9F);
  const auto by_distance = [&](const Vector3f& a, const Vector3f& b) {
    return (a - mean).squaredNorm() < (b - mean).squaredNorm();
  };
  auto next =
      static_cast<std::size_t>(std::ranges::min_element(points, by_distance) - points.begin());
  while (out.size() < std::min(kAnchors, points.size())) {
    out.push_back(next);
    for (std::size_t i = 0; i < points.size(); ++i) {
      nearest[i] = std::min(nearest[i], (points[i] - points[next]).squaredNorm());
    }
    next = static_cast<std::size_t>(std::ranges::max_element(nearest) - nearest.begin());
  }
  return out;
}

}  // namespace

std::vector<Side> SidesOf(const recognition::SurfaceModel& model) {
  std::vector<Side> out;
  for (int k = 0; k < kCameraDirections; ++k) {
    const Vector3f to_camera = rendering::EvenDirection(k, kCameraDirections);
    if (static_cast<double>(to_camera.z()) < kLowestSine) continue;
    Side side;
    side.look_object =
        Eigen::Quaternionf::FromTwoVectors(to_camera, -Vector3f::UnitZ()).toRotationMatrix();
    Eigen::Isometry3f sensor_object = Eigen::Isometry3f::Identity();
    sensor_object.linear() = side.look_object;
    sensor_object.translation() =
        Vector3f(0, 0, kCameraDistanceM) - side.look_object * model.center;
    const recognition::VisibleSurface visible(model.coarse, sensor_object);
    const std::vector<std::size_t>& seen = visible.points();
    if (seen.empty()) continue;
    const std::size_t count = std::min(kPoints, seen.size());
    for (std::size_t i = 0; i < count; ++i) {
      // Every prefix is spread over all of them.
      const std::size_t at = seen[(i * kPointStep % count) * seen.size() / count];
      side.points.push_back(model.coarse.cloud.points[at]);
      side.normals.push_back(model.coarse.cloud.normals[at]);
    }
    side.anchors = FarApart(side.points);
    out.push_back(std::move(side));
  }
  return out;
}

}  // namespace graspdb::client
