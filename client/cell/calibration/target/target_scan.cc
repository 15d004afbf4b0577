#include "client/cell/calibration/target/target_scan.h"

#include <numeric>
#include <utility>

#include "recognition/matching/refinement.h"
#include "recognition/verification/verification.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3f;
using recognition::Evidence;
using recognition::OrientedCloud;
using recognition::Points;
using recognition::Pose;
using recognition::RefinementOptions;
using recognition::SurfaceModel;

constexpr std::size_t kMinVoxels = 50;
constexpr RefinementOptions kRoughTargetSteps = {
    .iterations = 6, .first_reach_m = 0.02, .last_reach_m = 0.008, .coarse = true};
constexpr RefinementOptions kLastTargetSteps = {.iterations = 15, .first_reach_m = 0.01};
constexpr std::size_t kRoughStride = 3;
constexpr double kRoughToleranceM = 0.006;
constexpr double kToleranceM = 0.004;
// Points farther from the target's surface than this belong to the gripper.
constexpr float kNearM = 0.008F;
// Distance and normal cosine of points on the surface; maximum distance of points beside it.
constexpr float kOnM = 0.003F;
constexpr float kFacing = 0.8F;
constexpr float kBesideM = 0.02F;

}  // namespace

TargetScan::TargetScan(const Points& points, const Points& scan, const Pose& world_sensor,
                       bool on_table)
    : point_count_(points.size()),
      world_sensor_(world_sensor),
      on_table_(on_table),
      cloud_(recognition::PrepareCloud(recognition::Transform(world_sensor, points),
                                       world_sensor.translation(),
                                       recognition::DescriptorParameters())) {
  frame_.points = points;
  frame_.points.insert(frame_.points.end(), scan.begin(), scan.end());
}

recognition::DepthBuffer TargetScan::DepthBufferOf(recognition::Indices own) const {
  recognition::Segment segment;
  segment.indices = std::move(own);
  return {frame_, world_sensor_, segment};
}

void TargetScan::Count(const SurfaceModel& model, std::size_t stride, TargetFit* fit) const {
  const Eigen::Isometry3f target_world = fit->world_target.inverse().cast<float>();
  fit->own = 0;
  fit->beside = 0;
  for (std::size_t i = 0; i < cloud_.points.size(); i += stride) {
    const Vector3f p = target_world * cloud_.points[i];
    const float distance = model.DistanceTo(p);
    if (distance >= kBesideM) continue;
    if (distance >= kNearM) {
      fit->beside += 1;
    } else if (distance < kOnM) {
      const auto at = static_cast<std::size_t>(model.grid.Nearest(p));
      const Vector3f normal = target_world.linear() * cloud_.normals[i];
      if (normal.dot(model.fine.cloud.normals[at]) >= kFacing) fit->own += 1;
    }
  }
}

void TargetScan::RefineRoughly(const SurfaceModel& model, TargetFit* guesses,
                               std::size_t count) const {
  const recognition::NearestGrid grid = GridOf(cloud_.points);
  const recognition::SoaCloud columns(cloud_, kRoughStride);
  recognition::Indices all(point_count_);
  std::iota(all.begin(), all.end(), 0);
  const recognition::DepthBuffer depth_buffer = DepthBufferOf(std::move(all));
  const recognition::RefinementTarget target{cloud_, columns, grid, depth_buffer, on_table_, {}};
  for (std::size_t i = 0; i < count; ++i) {
    TargetFit& guess = guesses[i];
    guess.world_target =
        recognition::Refine(model, target, guess.world_target, kRoughTargetSteps).world_object;
    const Evidence evidence = Verify(model, guess.world_target, columns, depth_buffer,
                                     {.tolerance_m = kRoughToleranceM, .coarse = true});
    guess.seen = evidence.model_seen;
    guess.shown = evidence.unoccluded;
    Count(model, kRoughStride, &guess);
  }
}

TargetFit TargetScan::RefineOnce(const SurfaceModel& model, const Pose& world_target) const {
  const Eigen::Isometry3f target_world = world_target.inverse().cast<float>();
  TargetFit out{.world_target = world_target};
  OrientedCloud near;
  for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
    if (model.DistanceTo(target_world * cloud_.points[i]) >= kNearM) continue;
    near.points.push_back(cloud_.points[i]);
    near.normals.push_back(cloud_.normals[i]);
  }
  if (near.points.size() < kMinVoxels) return out;
  const Eigen::Isometry3f target_sensor = target_world * world_sensor_.cast<float>();
  recognition::Indices own;
  for (std::size_t i = 0; i < point_count_; ++i) {
    if (model.DistanceTo(target_sensor * frame_.points[i]) >= kNearM) continue;
    own.push_back(static_cast<std::int32_t>(i));
  }
  const recognition::DepthBuffer depth_buffer = DepthBufferOf(std::move(own));
  const recognition::SoaCloud columns(near);
  const recognition::NearestGrid grid = GridOf(near.points);
  recognition::RefinementTarget target{near, columns, grid, depth_buffer, on_table_, {}};
  if (on_table_) target.table = recognition::Plane();
  out.world_target =
      recognition::Refine(model, target, world_target, kLastTargetSteps).world_object;
  const Evidence evidence =
      Verify(model, out.world_target, columns, depth_buffer, {.tolerance_m = kToleranceM});
  out.seen = evidence.model_seen;
  out.shown = evidence.unoccluded;
  Count(model, 1, &out);
  return out;
}

TargetFit TargetScan::Refine(const SurfaceModel& model, const Pose& world_target) const {
  return RefineOnce(model, RefineOnce(model, world_target).world_target);
}

}  // namespace graspdb::client
