#include "rendering/camera/depth_camera.h"

#include <cmath>
#include <limits>
#include <utility>

#include "base/status_macros.h"
#include "recognition/base/units.h"

namespace graspdb::rendering {
namespace {

constexpr double kDropoutBeginRad = 70 * recognition::kRadiansPerDegree;
constexpr double kDropoutEndRad = 85 * recognition::kRadiansPerDegree;

}  // namespace

DepthCameraModel KinectV1() {
  DepthCameraModel model;
  model.intrinsics = {.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
  model.min_depth_m = 0.4;
  model.max_depth_m = 4.5;
  model.noise.axial = {.offset = 0.0012,
                       .linear = 0,
                       .quadratic = 0.0019,
                       .origin = 0.4,
                       .slant = 0.0001,
                       .slant_power = -0.5};
  model.noise.dropout_begin_rad = kDropoutBeginRad;
  model.noise.dropout_end_rad = kDropoutEndRad;
  model.noise.disparity_steps_m =
      8 * 0.075 * 580;  // steps a pixel, baseline, infrared focal length
  return model;
}

DepthCameraModel KinectV2() {
  DepthCameraModel model;
  model.intrinsics = {
      .width = 512, .height = 424, .fx = 365.5, .fy = 365.5, .cx = 255.5, .cy = 211.5};
  model.min_depth_m = 0.5;
  model.max_depth_m = 4.5;
  model.noise.axial = {.offset = 0.0015,
                       .linear = -0.0005,
                       .quadratic = 0.0003,
                       .origin = 0,
                       .slant = 0.0001,
                       .slant_power = 1.5};
  model.noise.dropout_begin_rad = kDropoutBeginRad;
  model.noise.dropout_end_rad = kDropoutEndRad;
  model.noise.flying_chance = 0.2;
  return model;
}

absl::StatusOr<DepthCamera> DepthCamera::Create(const DepthCameraModel& model) {
  ASSIGN_OR_RETURN(RayCaster rays, RayCaster::Create());
  return DepthCamera(model, std::move(rays));
}

absl::StatusOr<DepthFrame> DepthCamera::Render(const Scene& scene,
                                               const recognition::Pose& world_sensor,
                                               std::uint64_t seed) const {
  ASSIGN_OR_RETURN(IdealFrame frame, rays_.Cast(scene, model_.intrinsics, world_sensor));
  ApplyEdgeEffects(model_.effects, model_.intrinsics.fx, seed, frame);
  ApplyNoise(model_.noise, seed, frame);
  ApplyDepthEffects(model_.effects, seed, frame);
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i) {
    const double depth = frame.depth_m[i];
    if (depth >= model_.min_depth_m && depth <= model_.max_depth_m) continue;
    frame.depth_m[i] = 0;
    frame.surface[i] = kNoSurface;
  }
  return DepthFrame{.width = frame.width,
                    .height = frame.height,
                    .depth_m = std::move(frame.depth_m),
                    .surface = std::move(frame.surface)};
}

recognition::Points ToPoints(const DepthFrame& frame, const recognition::CameraIntrinsics& k) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  recognition::Points points(frame.depth_m.size(), Eigen::Vector3f::Constant(kNaN));
  std::size_t pixel = 0;
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u, ++pixel) {
      const double z = frame.depth_m[pixel];
      if (!(z > 0)) continue;
      points[pixel] =
          Eigen::Vector3d((u - k.cx) * z / k.fx, (v - k.cy) * z / k.fy, z).cast<float>();
    }
  }
  return points;
}

std::vector<std::uint16_t> ToCounts(const DepthFrame& frame, double unit_m) {
  std::vector<std::uint16_t> counts;
  counts.reserve(frame.depth_m.size());
  for (const float z : frame.depth_m) {
    const long count = std::lround(static_cast<double>(z) / unit_m);
    const bool fits = count <= std::numeric_limits<std::uint16_t>::max();
    counts.push_back(fits ? static_cast<std::uint16_t>(count) : 0);
  }
  return counts;
}

recognition::Pose LookAt(const Eigen::Vector3d& target, double distance_m, double look_down_deg,
                         double azimuth_deg) {
  const double down = look_down_deg * recognition::kRadiansPerDegree;
  const double turn = azimuth_deg * recognition::kRadiansPerDegree;
  const Eigen::Vector3d away(std::cos(down) * std::cos(turn), std::cos(down) * std::sin(turn),
                             std::sin(down));
  const Eigen::Vector3d forward = -away;
  const Eigen::Vector3d right(-std::sin(turn), std::cos(turn),
                              0);  // also when looking straight down
  recognition::Pose pose = recognition::Pose::Identity();
  pose.linear().col(0) = right;
  pose.linear().col(1) = forward.cross(right);
  pose.linear().col(2) = forward;
  pose.translation() = target + distance_m * away;
  return pose;
}

}  // namespace graspdb::rendering
