#include "recognition/verification.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "recognition/motion.h"

namespace graspdb::recognition {
namespace {

// Cosine between normal and line of sight below which a surface is too slanted to count.
constexpr float kMinFacing = 0.2F;
// Cells of the visibility test are so many times larger than the points are apart.
constexpr float kCellsPerSpacing = 2.5F;
// A surface hides what lies farther behind it than this, m, or than a cell is large.
constexpr float kHidesBehindM = 0.008F;
constexpr int kLargestSide = 512;
// What a scan of one thing alone does not show speaks less against it than free sight through it.
constexpr float kMissingWeight = 0.3F;
constexpr float kFar = 1e9F;

// Points of a surface as a sensor sees them.
struct Facing {
  Facing(const Surface& surface, const Motion& sensor_surface)
      : x(surface.columns.coordinates().points.count), y(x.size()), z(x.size()), is(x.size()) {
    wide::Best().face(surface.columns.coordinates(), sensor_surface.rigid(), kMinFacing, x.data(),
                      y.data(), z.data(), is.data());
    for (std::size_t i = 0; i < is.size(); ++i) {
      if (is[i] != 0) all.push_back(i);
    }
  }

  std::vector<float> x;  // sensor frame, m
  std::vector<float> y;
  std::vector<float> z;
  std::vector<std::uint8_t> is;  // 1: faces the sensor
  std::vector<std::size_t> all;  // that do
};

// Takes away what others of the surface hide.
void Hide(float spacing_m, Facing* facing) {
  if (facing->all.empty()) return;
  Eigen::AlignedBox2f window;
  float depth = kFar;
  std::vector<Eigen::Vector2f> at;
  at.reserve(facing->all.size());
  for (const std::size_t i : facing->all) {
    at.emplace_back(facing->x[i] / facing->z[i], facing->y[i] / facing->z[i]);
    window.extend(at.back());
    depth = std::min(depth, facing->z[i]);
  }
  const float cell = std::max(kCellsPerSpacing * spacing_m / depth,
                              window.sizes().maxCoeff() / (kLargestSide - 1));
  const Eigen::Vector2i size = (window.sizes() / cell).cast<int>().array() + 1;
  std::vector<float> nearest(
      static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()), kFar);
  std::vector<std::size_t> cell_of;
  cell_of.reserve(at.size());
  for (std::size_t k = 0; k < at.size(); ++k) {
    const Eigen::Vector2i c = ((at[k] - window.min()) / cell).cast<int>();
    cell_of.push_back(static_cast<std::size_t>(c.y()) * static_cast<std::size_t>(size.x()) +
                      static_cast<std::size_t>(c.x()));
    float& here = nearest[cell_of.back()];
    here = std::min(here, facing->z[facing->all[k]]);
  }
  const float behind = std::max(kHidesBehindM, kCellsPerSpacing * spacing_m);
  for (std::size_t k = 0; k < at.size(); ++k) {
    const std::size_t i = facing->all[k];
    facing->is[i] = facing->z[i] <= nearest[cell_of[k]] + behind;
  }
}

}  // namespace

Indices VisiblePoints(const Surface& surface, const Eigen::Isometry3f& sensor_object) {
  Facing facing(surface, Motion(sensor_object));
  Hide(surface.spacing_m, &facing);
  Indices out;
  for (const std::size_t i : facing.all) {
    if (facing.is[i] != 0) out.push_back(static_cast<std::int32_t>(i));
  }
  return out;
}

Evidence Verify(const SurfaceModel& model, const Pose& world_object, const OrientedColumns& segment,
                const Sight& sight, const VerificationOptions& options) {
  Evidence out;
  const auto tolerance = static_cast<float>(options.tolerance_m);
  const auto points = static_cast<double>(segment.point_count());
  if (points == 0 || model.fine.cloud.points.empty()) return out;
  out.point_count = segment.point_count();
  const wide::Support support =
      wide::Best().support(segment.coordinates().points, Motion(world_object.inverse()).rigid(),
                           model.look_up(), kSurfaceSpacingM, tolerance);
  out.scan_explained = static_cast<double>(support.explained) / points;
  out.rms_m = support.near > 0 ? static_cast<double>(std::sqrt(support.squares / support.near)) : 0;

  // The score if all of the model were seen.
  if (2 * out.scan_explained < options.min_score * (1 + out.scan_explained)) return out;

  const Motion sensor_object(sight.sensor_world() * world_object.cast<float>());
  const Surface& surface = options.coarse ? model.coarse : model.fine;
  Facing facing(surface, sensor_object);
  Hide(surface.spacing_m, &facing);
  const wide::Seen seen =
      wide::Best().look(surface.columns.coordinates(), sensor_object.rigid(), facing.is.data(),
                        sight.window(), tolerance, kMissingWeight);
  out.in_sight = seen.all > 0 ? static_cast<double>(seen.expected / seen.all) : 0;
  if (seen.all > 0) {
    out.confirmed = static_cast<double>(seen.confirmed / seen.all);
    out.contradicted = static_cast<double>(seen.contradicted / seen.all);
    out.unmeasured = static_cast<double>(seen.unmeasured / seen.all);
  }
  out.model_seen = seen.expected > 0 ? static_cast<double>(seen.found / seen.expected) : 0;
  const double sum = out.scan_explained + out.model_seen;
  out.score = sum > 0 ? 2 * out.scan_explained * out.model_seen / sum : 0;
  return out;
}

}  // namespace graspdb::recognition
