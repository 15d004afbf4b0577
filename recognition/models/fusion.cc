#include "recognition/models/fusion.h"

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "recognition/points/cell_grid.h"
#include "recognition/points/cell_key.h"

namespace graspdb::recognition {
namespace {

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

OrientedCloud Fused(std::span<const PosedCloud> views) {
  Cells cells;
  for (std::size_t i = 0; i < views.size(); ++i) cells.Add(views[i], i);
  return WithoutDoubles(Laid(MeansOf(cells.surfels(), views.size() >= kViewsThatOverlap ? 2 : 1)));
}

}  // namespace graspdb::recognition
