#include "client/calibration/sharp_model.h"

#include <cmath>
#include <vector>

#include "recognition/point_search.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3f;
using recognition::Neighbor;
using recognition::OrientedCloud;

// Around a point, m, and the deviation of the weights.
constexpr float kRadiusM = 0.007F;
constexpr float kDeviationM = 0.003F;
// Cosine between normals of one face.
constexpr float kSameFace = 0.9F;
constexpr int kRounds = 2;

// All points of all views in the frame of the object.
OrientedCloud Together(std::span<const recognition::PosedCloud> views) {
  OrientedCloud out;
  for (const recognition::PosedCloud& view : views) {
    const Eigen::Isometry3f object_world = view.world_object.inverse().cast<float>();
    for (std::size_t i = 0; i < view.cloud->points.size(); ++i) {
      out.points.push_back(object_world * view.cloud->points[i]);
      out.normals.emplace_back(object_world.linear() * view.cloud->normals[i]);
    }
  }
  return out;
}

// Moves one point across the surface, on the plane that its neighbours make.
void Settle(const OrientedCloud& all, const recognition::PointSearch& search,
            std::vector<Neighbor>* neighbors, Vector3f* point, Vector3f* normal) {
  search.Within(*point, kRadiusM, neighbors);
  Vector3f mean = Vector3f::Zero();
  Vector3f direction = Vector3f::Zero();
  float sum = 0;
  for (const Neighbor& neighbor : *neighbors) {
    const auto i = static_cast<std::size_t>(neighbor.index);
    if (all.normals[i].dot(*normal) < kSameFace) continue;
    const float weight = std::exp(-neighbor.squared_distance / (2 * kDeviationM * kDeviationM));
    mean += weight * all.points[i];
    direction += weight * all.normals[i];
    sum += weight;
  }
  if (!(sum > 0)) return;
  *normal = direction.normalized();
  *point += normal->dot(mean / sum - *point) * *normal;
}

}  // namespace

std::shared_ptr<const recognition::SurfaceModel> FuseSharply(
    std::span<const recognition::PosedCloud> views) {
  const auto fused = recognition::FuseViews(views);
  if (fused == nullptr) return nullptr;
  const OrientedCloud all = Together(views);
  const recognition::PointSearch search(all.points);
  OrientedCloud sharp = fused->fine.cloud;
  std::vector<Neighbor> neighbors;
  for (std::size_t i = 0; i < sharp.points.size(); ++i) {
    for (int round = 0; round < kRounds; ++round) {
      Settle(all, search, &neighbors, &sharp.points[i], &sharp.normals[i]);
    }
  }
  auto out = std::make_shared<recognition::SurfaceModel>(std::move(sharp), fused->view_count);
  out->deviation_m = fused->deviation_m;
  return out;
}

}  // namespace graspdb::client
