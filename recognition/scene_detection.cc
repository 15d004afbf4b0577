#include "recognition/scene_detection.h"

#include <algorithm>
#include <cmath>

#include "recognition/matching/refinement.h"
#include "recognition/matching/segment_matcher.h"
#include "recognition/segment_recognition.h"
#include "recognition/segmentation/segment_part.h"
#include "recognition/verification/confidence.h"
#include "recognition/verification/verification.h"

namespace graspdb::recognition {
namespace {

struct PosedStablePose {
  const TaughtStablePose* stable_pose = nullptr;
  Pose world_object = Pose::Identity();
  double upright = -1;  // cosine between its z axis and up
};

// Towards the sensor where up is not known: what lies before it is grasped from there.
Eigen::Vector3d Up(const Segmentation& segmentation) {
  return {0, 0, segmentation.HasGravity() ? 1.0 : -1.0};
}

PosedStablePose MostUpright(const StablePoses& stable_poses, const Pose& world_model,
                            const Eigen::Vector3d& up) {
  PosedStablePose out;
  for (const auto& stable_pose : stable_poses) {
    const Pose object_model = stable_pose->object_mesh.value_or(Pose::Identity());
    const Pose world_object = world_model * object_model.inverse();
    const double upright = world_object.linear().col(2).dot(up);
    if (out.stable_pose != nullptr && upright <= out.upright) continue;
    out = {stable_pose.get(), world_object, upright};
  }
  return out;
}

// The direction to the sensor, object frame.
Eigen::Vector3d TowardsSensor(const Pose& world_object, const Pose& world_sensor) {
  return (world_object.inverse() * world_sensor.translation()).normalized();
}

// An object no farther than this from the table stands on it, m.
constexpr float kStandsWithinM = 0.010F;

// Maximum distance of an object's own points from its model, in deviations, and its lower limit, m.
constexpr double kOwnDeviations = 3;
constexpr double kMinOwnM = 0.0035;

// The points of `segment` that lie on the aligned model. Those of a touching neighbour do not.
Segment OnModel(const OwnPoints& own, const Segment& segment, const Detection& d, double reach_m) {
  const auto limit = static_cast<float>(
      std::clamp(kOwnDeviations * d.evidence.rms_m, std::min(kMinOwnM, reach_m), reach_m));
  const Eigen::Isometry3f object_world = d.refined_pose.inverse().cast<float>();
  return PartOf(own.scan, own.segmentation, segment, [&](const Eigen::Vector3f& p) {
    return d.model->DistanceTo(object_world * p) < limit;
  });
}

// Aligns the model with `segment`, and judges it on that.
void AlignWith(const OwnPoints& own, const Segment& segment, bool stands,
               const MatchingParameters& matching, const IsCancelled& is_cancelled, Detection* d) {
  const DepthBuffer depth_buffer(own.depths, own.segmentation.world_sensor, segment);
  const SoaCloud columns(segment.cloud, StrideFor(segment, kFullPoints));
  const NearestGrid grid(segment.cloud.points, kSegmentCellM, kSegmentReachM, is_cancelled);
  const RefinementTarget target{segment.cloud, columns, grid,
                                depth_buffer,  stands,  own.segmentation.table};
  d->point_count = segment.cloud.points.size();
  d->centroid = segment.centroid;
  const Refinement first = Refine(*d->model, target, d->rough_pose, kFirstSteps);
  const Refinement last = Refine(*d->model, target, first.world_object, kLastSteps);
  d->refined_pose = last.world_object;
  d->evidence = Verify(*d->model, d->refined_pose, columns, depth_buffer,
                       {.tolerance_m = matching.support_distance_m});
  d->features = ConfidenceFeaturesOf(d->evidence, *d->model, NoiseAt(own.segmentation, segment),
                                     matching.support_distance_m);
  d->score = Confidence(d->features);
  d->registration = {.target_source = Pose::Identity(),
                     .converged = last.converged,
                     .iterations = first.iterations + last.iterations,
                     .rms_error_m = d->evidence.rms_m,
                     .inlier_fraction = d->evidence.confirmed};
}

bool IsTilted(const Pose& world_object, const Segmentation& segmentation,
              const RecognitionParameters& parameters) {
  return segmentation.HasGravity() &&
         world_object.linear()(2, 2) < std::cos(parameters.scene.max_tilt_rad);
}

bool Stands(const SceneHypothesis& hypothesis, const Pose& world_object,
            const Segmentation& segmentation, const RecognitionParameters& parameters) {
  return !IsTilted(world_object, segmentation, parameters) && hypothesis.clearance_m &&
         std::abs(*hypothesis.clearance_m) < kStandsWithinM;
}

}  // namespace

absl::StatusOr<std::optional<Detection>> DetectionOf(const SceneHypothesis& hypothesis,
                                                     const StablePoses& stable_poses,
                                                     const OwnPoints& own, ViewClouds& clouds,
                                                     const RecognitionParameters& parameters,
                                                     const IsCancelled& is_cancelled) {
  const Pose& world_sensor = own.segmentation.world_sensor;
  const Pose world_model = world_sensor * hypothesis.sensor_object.cast<double>();
  const auto [stable_pose, world_object, upright] =
      MostUpright(stable_poses, world_model, Up(own.segmentation));
  std::optional<Detection> out;
  const bool may_lie = stable_pose->object_mesh.has_value();
  if (!may_lie && IsTilted(world_object, own.segmentation, parameters)) return out;
  Detection& d = out.emplace();
  const Eigen::Vector3d here = TowardsSensor(world_object, world_sensor);
  d.view = *std::ranges::max_element(stable_pose->views, {}, [&here](const auto& view) {
    return TowardsSensor(view->world_object, view->world_sensor).dot(here);
  });
  auto surface = clouds.LoadModel(*d.view, *stable_pose);
  if (!surface.ok()) return surface.status();
  d.model = *std::move(surface);
  if (d.model == nullptr) return std::nullopt;
  d.rough_pose = world_object;
  AlignWith(own, own.segment, Stands(hypothesis, world_object, own.segmentation, parameters),
            parameters.matching, is_cancelled, &d);
  return out;
}

std::optional<Detection> WithoutNeighbours(const SceneHypothesis& hypothesis,
                                           const Detection& detection, const OwnPoints& own,
                                           const RecognitionParameters& parameters,
                                           const IsCancelled& is_cancelled) {
  const Segment on_model =
      OnModel(own, own.segment, detection, parameters.matching.support_distance_m);
  const auto fewest = static_cast<std::size_t>(parameters.segmentation.min_cluster_point_count);
  if (on_model.cloud.points.size() < fewest) return std::nullopt;
  Detection out = detection;
  out.rough_pose = detection.refined_pose;
  AlignWith(own, on_model, Stands(hypothesis, detection.rough_pose, own.segmentation, parameters),
            parameters.matching, is_cancelled, &out);
  out.rough_pose = detection.rough_pose;
  return out;
}

}  // namespace graspdb::recognition
