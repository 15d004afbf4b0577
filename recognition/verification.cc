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
constexpr double kMissingWeight = 0.3;

float Weight(float distance, float tolerance) {
  const float share = distance / tolerance;
  return share < 1 ? 1 - share * share : 0;
}

}  // namespace

Indices VisiblePoints(const Surface& surface, const Eigen::Isometry3f& sensor_object) {
  const Points& points = surface.cloud.points;
  const Motion motion(sensor_object);
  Points seen(points.size());
  Indices facing;
  Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9F);
  Eigen::Vector2f high = -low;
  float depth = 1e9F;
  for (std::size_t i = 0; i < points.size(); ++i) {
    seen[i] = motion.Point(points[i]);
    const Eigen::Vector3f normal = motion.Direction(surface.cloud.normals[i]);
    if (seen[i].z() <= 0 || -normal.dot(seen[i]) < kMinFacing * seen[i].norm()) continue;
    facing.push_back(static_cast<std::int32_t>(i));
    low = low.cwiseMin(seen[i].head<2>() / seen[i].z());
    high = high.cwiseMax(seen[i].head<2>() / seen[i].z());
    depth = std::min(depth, seen[i].z());
  }
  if (facing.empty()) return facing;
  const float cell = std::max(kCellsPerSpacing * surface.spacing_m / depth,
                              (high - low).maxCoeff() / (kLargestSide - 1));
  const Eigen::Vector2i size = ((high - low) / cell).cast<int>().array() + 1;
  std::vector<float> nearest(
      static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()), 1e9F);
  const auto cell_of = [&](const Eigen::Vector3f& p) -> float& {
    const Eigen::Vector2i c = ((p.head<2>() / p.z() - low) / cell).cast<int>();
    return nearest[static_cast<std::size_t>(c.y()) * static_cast<std::size_t>(size.x()) +
                   static_cast<std::size_t>(c.x())];
  };
  for (const std::int32_t i : facing) {
    const Eigen::Vector3f& p = seen[static_cast<std::size_t>(i)];
    cell_of(p) = std::min(cell_of(p), p.z());
  }
  const float behind = std::max(kHidesBehindM, kCellsPerSpacing * surface.spacing_m);
  std::erase_if(facing, [&](std::int32_t i) {
    const Eigen::Vector3f& p = seen[static_cast<std::size_t>(i)];
    return p.z() > cell_of(p) + behind;
  });
  return facing;
}

Evidence Verify(const SurfaceModel& model, const Pose& world_object, const Segment& segment,
                const Sight& sight, const VerificationOptions& options) {
  Evidence out;
  const auto tolerance = static_cast<float>(options.tolerance_m);
  const Motion object_world(world_object.inverse());
  double explained = 0;
  double squares = 0;
  double near = 0;
  double points = 0;
  for (std::size_t i = 0; i < segment.cloud.points.size();
       i += static_cast<std::size_t>(options.stride), ++points) {
    const float d = model.DistanceTo(object_world.Point(segment.cloud.points[i]));
    explained += static_cast<double>(Weight(d, tolerance));
    if (d >= tolerance) continue;
    squares += static_cast<double>(d * d);
    near += 1;
  }
  if (points == 0) return out;
  out.scan_explained = explained / points;
  out.rms_m = near > 0 ? std::sqrt(squares / near) : 0;

  const Eigen::Isometry3f sensor_object = sight.sensor_world() * world_object.cast<float>();
  const Motion motion(sensor_object);
  double expected = 0;
  double found = 0;
  double all = 0;
  const Surface& surface = options.coarse ? model.coarse : model.fine;
  for (const std::int32_t i : VisiblePoints(surface, sensor_object)) {
    const Eigen::Vector3f p = motion.Point(surface.cloud.points[static_cast<std::size_t>(i)]);
    const Eigen::Vector3f n = motion.Direction(surface.cloud.normals[static_cast<std::size_t>(i)]);
    const double area = static_cast<double>(-n.dot(p.normalized()));
    const Sight::Look look = sight.At(p, n, tolerance);
    all += area;
    if (look.finding == Sight::Finding::kHidden || look.finding == Sight::Finding::kUnknown) {
      continue;
    }
    expected += look.finding == Sight::Finding::kMissing ? kMissingWeight * area : area;
    if (look.finding == Sight::Finding::kThere) {
      found += area * static_cast<double>(Weight(look.distance_m, tolerance));
    }
  }
  out.in_sight = all > 0 ? expected / all : 0;
  out.model_seen = expected > 0 ? found / expected : 0;
  const double sum = out.scan_explained + out.model_seen;
  out.score = sum > 0 ? 2 * out.scan_explained * out.model_seen / sum : 0;
  return out;
}

}  // namespace graspdb::recognition
