#include "recognition/scene_detection.h"

#include <algorithm>
#include <cmath>

#include "recognition/segment_recognition.h"

namespace graspdb::recognition {
namespace {

struct PosedStablePose {
  const TaughtStablePose* stable_pose = nullptr;
  Pose world_object = Pose::Identity();
  double upright = -1;  // cosine between its z axis and the world's
};

PosedStablePose MostUpright(const StablePoses& stable_poses, const Pose& world_model) {
  PosedStablePose out;
  for (const auto& stable_pose : stable_poses) {
    const Pose object_model = stable_pose->object_mesh.value_or(Pose::Identity());
    const Pose world_object = world_model * object_model.inverse();
    const double upright = world_object.linear()(2, 2);
    if (out.stable_pose != nullptr && upright <= out.upright) continue;
    out = {stable_pose.get(), world_object, upright};
  }
  return out;
}

// The direction to the sensor, object frame.
Eigen::Vector3d TowardsSensor(const Pose& world_object, const Pose& world_sensor) {
  return (world_object.inverse() * world_sensor.translation()).normalized();
}

Evidence EvidenceOf(const SceneHypothesis& hypothesis) {
  const SurfaceEvidence& s = hypothesis.surface;
  const float measured = std::max(1e-3F, s.seen + s.contradicted + s.table);
  return {.scan_explained = s.seen / measured,
          .model_seen = s.seen,
          .unoccluded = 1 - s.hidden,
          .rms_m = s.rms_m,
          .score = hypothesis.score,
          .confirmed = s.seen,
          .contradicted = s.contradicted + s.table,
          .unmeasured = s.unmeasured,
          .point_count = s.seen_count};
}

}  // namespace

absl::StatusOr<std::optional<Detection>> DetectionOf(const SceneHypothesis& hypothesis,
                                                     double score, const PairModel& model,
                                                     const StablePoses& stable_poses,
                                                     const Pose& world_sensor, ViewClouds& clouds,
                                                     const RecognitionParameters& parameters) {
  const Pose world_model = world_sensor * hypothesis.sensor_object.cast<double>();
  const auto [stable_pose, world_object, upright] = MostUpright(stable_poses, world_model);
  const bool is_tilted = upright < std::cos(parameters.scene.max_tilt_rad);
  std::optional<Detection> out;
  if (is_tilted && !stable_pose->object_mesh) return out;
  if (score < MinScore(stable_pose, parameters.matching)) return out;
  Detection& d = out.emplace();
  const Eigen::Vector3d here = TowardsSensor(world_object, world_sensor);
  d.view = *std::ranges::max_element(stable_pose->views, {}, [&here](const auto& view) {
    return TowardsSensor(view->world_object, view->world_sensor).dot(here);
  });
  auto surface = clouds.LoadModel(*d.view, *stable_pose);
  if (!surface.ok()) return surface.status();
  d.model = *std::move(surface);
  d.score = score;
  d.rough_pose = world_object;
  d.refined_pose = world_object;
  d.evidence = EvidenceOf(hypothesis);
  d.registration = {.target_source = Pose::Identity(),
                    .converged = hypothesis.converged,
                    .iterations = parameters.scene.object_search.last_steps.iterations,
                    .rms_error_m = d.evidence.rms_m,
                    .inlier_fraction = d.evidence.scan_explained};
  d.point_count = hypothesis.surface.seen_count;
  d.centroid = world_model * model.center.cast<double>();
  CompleteDetection(stable_pose, parameters.workspace, &d);
  return out;
}

}  // namespace graspdb::recognition
