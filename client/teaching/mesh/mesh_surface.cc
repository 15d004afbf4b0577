#include "client/teaching/mesh/mesh_surface.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace graspdb::client {
namespace {

// Samples are denser than the points that are computed from them.
constexpr double kSampleSpacingM = recognition::kSurfaceSpacingM / 2.0;
constexpr double kMinSamples = 2000;
constexpr double kMaxSamples = 60'000;
constexpr std::uint64_t kSeed = 1;

}  // namespace

recognition::OrientedCloud SurfaceOf(const rendering::TriangleMesh& mesh) {
  const double wanted = rendering::AreaOf(mesh) / (kSampleSpacingM * kSampleSpacingM);
  const int count = static_cast<int>(std::clamp(wanted, kMinSamples, kMaxSamples));
  auto samples = std::make_shared<const recognition::OrientedCloud>(
      rendering::SampleOrientedSurface(mesh, count, kSeed));
  const std::vector<recognition::PosedCloud> views = {{std::move(samples)}};
  const auto fused = recognition::FuseViews(views);
  return fused ? fused->fine.cloud : recognition::OrientedCloud{};
}

recognition::SurfaceModel Posed(const recognition::OrientedCloud& surface,
                                const recognition::Pose& object_mesh) {
  const Eigen::Isometry3f forth = object_mesh.cast<float>();
  recognition::OrientedCloud moved = surface;
  for (Eigen::Vector3f& p : moved.points) p = forth * p;
  for (Eigen::Vector3f& n : moved.normals) n = forth.linear() * n;
  return {std::move(moved), 1};
}

}  // namespace graspdb::client
