#include "recognition/models/surface_model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "recognition/base/bounds.h"
#include "recognition/points/cell_key.h"

namespace graspdb::recognition {
namespace {

// Points of the coarse surface, about.
constexpr float kCoarsePoints = 350;
// The grid for look-ups: its cells, and how far from the surface it reaches, m.
constexpr float kGridCellM = 0.003F;
constexpr float kGridReachM = 0.021F;
// Points farther from the surface belong to another one, m.
constexpr float kDeviationReachM = 0.008F;
// Stride of the measured points.
constexpr std::size_t kDeviationStride = 4;

// One point of each cell, and of each side that the surface has there.
Surface Thinned(const Surface& fine) {
  OrientedCloud out;
  const auto count = static_cast<float>(fine.cloud.points.size());
  const float spacing_m = fine.spacing_m * std::max(1.0F, std::sqrt(count / kCoarsePoints));
  std::unordered_map<std::uint64_t, Normals> taken;
  for (std::size_t i = 0; i < fine.cloud.points.size(); ++i) {
    const Eigen::Vector3f& n = fine.cloud.normals[i];
    Normals& here = taken[CellKey(fine.cloud.points[i], spacing_m)];
    const auto is_same_side = [&](const Eigen::Vector3f& other) {
      return other.dot(n) > kSameSide;
    };
    if (std::any_of(here.begin(), here.end(), is_same_side)) continue;
    here.push_back(n);
    out.points.push_back(fine.cloud.points[i]);
    out.normals.push_back(n);
  }
  return {std::move(out), spacing_m};
}

float DeviationOf(const SurfaceModel& model, std::span<const PosedCloud> views) {
  double squares = 0;
  double count = 0;
  for (const PosedCloud& view : views) {
    const Eigen::Isometry3f object_world = view.world_object.inverse().cast<float>();
    for (std::size_t i = 0; i < view.cloud->points.size(); i += kDeviationStride) {
      const float d = model.DistanceTo(object_world * view.cloud->points[i]);
      if (d >= kDeviationReachM) continue;
      squares += static_cast<double>(d * d);
      count += 1;
    }
  }
  return count > 0 ? static_cast<float>(std::sqrt(squares / count)) : 0;
}

}  // namespace

SurfaceModel::SurfaceModel(OrientedCloud fused, int views)
    : fine(std::move(fused), kFusionCellM),
      coarse(Thinned(fine)),
      grid(fine.cloud.points, kGridCellM, kGridReachM),
      view_count(views) {
  const Points& points = fine.cloud.points;
  if (points.empty()) return;
  center = BoundsOf(points).center();
  for (const Eigen::Vector3f& p : points) radius_m = std::max(radius_m, (p - center).norm());
}

float SurfaceModel::DistanceTo(const Eigen::Vector3f& p) const {
  const int nearest = grid.Nearest(p);
  if (nearest < 0) return 1;
  const auto i = static_cast<std::size_t>(nearest);
  const Eigen::Vector3f d = p - fine.cloud.points[i];
  const float across = d.dot(fine.cloud.normals[i]);
  const float along = std::sqrt(std::max(0.0F, d.squaredNorm() - across * across));
  const float beyond = std::max(0.0F, along - kSurfaceSpacingM);
  return std::sqrt(across * across + beyond * beyond);
}

std::size_t SurfaceModel::bytes() const {
  std::size_t out = sizeof(*this) + grid.bytes();
  for (const Surface* surface : {&fine, &coarse}) {
    out += 2 * sizeof(Eigen::Vector3f) * surface->cloud.points.size() + surface->columns.bytes();
  }
  return out;
}

std::shared_ptr<const SurfaceModel> FuseViews(std::span<const PosedCloud> views) {
  OrientedCloud fused = Fused(views);
  if (fused.points.empty()) return nullptr;
  auto model = std::make_shared<SurfaceModel>(std::move(fused), static_cast<int>(views.size()));
  model->deviation_m = DeviationOf(*model, views);
  return model;
}

}  // namespace graspdb::recognition
