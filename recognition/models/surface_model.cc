#include "recognition/models/surface_model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "recognition/base/bounds.h"
#include "recognition/points/cell_grid.h"
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

using Eigen::Vector3f;

// From this many views on, more than one sees each surface.
constexpr std::size_t kViewsThatOverlap = 6;

// Projection of a point: deviation of its neighbours' weights, and their radius, m.
constexpr float kWeightDeviationM = 0.003F;
constexpr float kWeightReachM = 2 * kWeightDeviationM;
// Cosine between normals of one face.
constexpr float kSameFace = 0.9F;
// Points of one side that are nearer than this are one, m.
constexpr float kMinSpacingM = 0.0015F;

struct Surfel {
  Vector3f point = Vector3f::Zero();  // sums
  Vector3f normal = Vector3f::Zero();
  float count = 0;
  std::size_t last_view = 0;
  int views = 0;
};

class Cells {
 public:
  void Add(const PosedCloud& view, std::size_t number) {
    const Eigen::Isometry3f object_world = view.world_object.inverse().cast<float>();
    const OrientedCloud& cloud = *view.cloud;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Vector3f p = object_world * cloud.points[i];
      const Vector3f n = object_world.linear() * cloud.normals[i];
      Surfel& surfel = Find(CellKey(p, kFusionCellM), n);
      surfel.views += surfel.count == 0 || surfel.last_view != number;
      surfel.point += p;
      surfel.normal += n;
      surfel.count += 1;
      surfel.last_view = number;
    }
  }

  const std::vector<Surfel>& surfels() const { return surfels_; }

 private:
  Surfel& Find(std::uint64_t key, const Vector3f& normal) {
    std::vector<std::size_t>& here = cells_[key];
    for (const std::size_t i : here) {
      if (surfels_[i].normal.normalized().dot(normal) > kSameSide) return surfels_[i];
    }
    here.push_back(surfels_.size());
    return surfels_.emplace_back();
  }

  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
  std::vector<Surfel> surfels_;  // in the order of their first points
};

// Means of cells, and of how many points each is.
struct Means {
  OrientedCloud cloud;
  std::vector<float> counts;
};

Means MeansOf(const std::vector<Surfel>& surfels, int needed_views) {
  Means out;
  for (const Surfel& s : surfels) {
    if (s.views < needed_views || s.normal.norm() < 1e-6F) continue;
    out.cloud.points.push_back(s.point / s.count);
    out.cloud.normals.push_back(s.normal.normalized());
    out.counts.push_back(s.count);
  }
  return out;
}

// Projects one point onto the surface of its neighbours. The chord of two points of a circle is
// perpendicular to the mean of their normals: the deviation from that gives the distance of a
// point, also on a round object, into which the neighbours' plane would move it.
void Lay(const Means& means, const CellGrid& grid, Vector3f* point, Vector3f* normal) {
  float off = 0;
  float weights = 0;
  Vector3f direction = Vector3f::Zero();
  grid.ForEachPoint(*point, 1, [&](std::size_t i) {
    const Vector3f& n = means.cloud.normals[i];
    const Vector3f to = means.cloud.points[i] - *point;
    const float squared = to.squaredNorm();
    if (squared > kWeightReachM * kWeightReachM || n.dot(*normal) < kSameFace) return;
    const float weight =
        means.counts[i] * std::exp(-squared / (2 * kWeightDeviationM * kWeightDeviationM));
    off += weight * to.dot((n + *normal).normalized());
    direction += weight * n;
    weights += weight;
  });
  *point += off / weights * *normal;  // the point itself is among them
  *normal = direction.normalized();
}

// The means, projected onto their surface.
OrientedCloud Laid(const Means& means) {
  OrientedCloud out = means.cloud;
  const CellGrid grid(out.points, kWeightReachM);
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    Lay(means, grid, &out.points[i], &out.normals[i]);
  }
  return out;
}

// Without duplicates of two layers: of coincident points the first remains.
OrientedCloud WithoutDoubles(const OrientedCloud& laid) {
  const CellGrid grid(laid.points, kMinSpacingM);
  std::vector<char> is_double(laid.points.size());
  OrientedCloud out;
  for (std::size_t i = 0; i < laid.points.size(); ++i) {
    if (is_double[i]) continue;
    const Vector3f& p = laid.points[i];
    const Vector3f& n = laid.normals[i];
    out.points.push_back(p);
    out.normals.push_back(n);
    grid.ForEachPoint(p, 1, [&](std::size_t j) {
      const float squared = (laid.points[j] - p).squaredNorm();
      is_double[j] |= squared < kMinSpacingM * kMinSpacingM && laid.normals[j].dot(n) > kSameSide;
    });
  }
  return out;
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

OrientedCloud Fused(std::span<const PosedCloud> views) {
  Cells cells;
  for (std::size_t i = 0; i < views.size(); ++i) cells.Add(views[i], i);
  return WithoutDoubles(Laid(MeansOf(cells.surfels(), views.size() >= kViewsThatOverlap ? 2 : 1)));
}

}  // namespace graspdb::recognition
