// A simulated depth camera.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"
#include "rendering/camera/depth_noise.h"
#include "rendering/camera/ray_caster.h"
#include "rendering/camera/scene.h"
#include "rendering/camera/sensor_effects.h"

namespace graspdb::rendering {

// A pinhole camera, its depth range and its errors.
struct DepthCameraModel {
  recognition::CameraIntrinsics intrinsics;
  double min_depth_m = 0;
  double max_depth_m = 0;
  DepthNoise noise;
  SensorEffects effects = {};
  bool operator==(const DepthCameraModel&) const = default;
};

// Structured light, 640 x 480. Axial noise after Nguyen, Izadi and Lovell,
// "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and Tracking",
// 3DIMPVT 2012; disparity in eighths of a pixel over a baseline of 75 mm.
DepthCameraModel KinectV1();

// Time of flight, 512 x 424, with flying pixels. Axial noise after Fankhauser et
// al., "Kinect v2 for Mobile Robot Navigation: Evaluation and Modeling", ICAR
// 2015: 1.3 mm at 0.8 m, 1.7 mm at 2 m.
DepthCameraModel KinectV2();

// Cameras with the errors of real ones; camera_presets.cc gives the source of each value. The first
// two extend those above.
DepthCameraModel RealKinectV1();
DepthCameraModel RealKinectV2();
DepthCameraModel RealSenseD4xx();
DepthCameraModel Carmine();

// By name, for command lines and sensors: "v1", "v2" (per-pixel noise only), "kinect-v1",
// "kinect-v2", "realsense-d4xx", "carmine". INVALID_ARGUMENT for another name.
std::vector<std::string> SimulatedCameras();
absl::StatusOr<DepthCameraModel> SimulatedCameraOf(const std::string& name);

// A depth image, row by row.
struct DepthFrame {
  int width = 0;
  int height = 0;
  std::vector<float> depth_m;         // along the sensor's z axis; 0: no measurement
  std::vector<std::int32_t> surface;  // object of the pixel, see scene.h
};

// Renders frames. Thread-safe.
class DepthCamera {
 public:
  // INTERNAL when the ray caster cannot start.
  static absl::StatusOr<DepthCamera> Create(const DepthCameraModel& model);

  // The frame of the camera at `world_sensor` (T_world_sensor). The same arguments give the same
  // bytes on one machine. Errors as RayCaster::Cast.
  absl::StatusOr<DepthFrame> Render(const Scene& scene, const recognition::Pose& world_sensor,
                                    std::uint64_t seed) const;

  const DepthCameraModel& model() const { return model_; }

 private:
  DepthCamera(const DepthCameraModel& model, RayCaster rays)
      : model_(model), rays_(std::move(rays)) {}

  DepthCameraModel model_;
  RayCaster rays_;
};

// The frame as an organised cloud in the sensor frame, metres; NaN without a measurement. `frame`
// must have the size of `intrinsics`.
recognition::Points ToPoints(const DepthFrame& frame,
                             const recognition::CameraIntrinsics& intrinsics);

// The frame as a depth image: counts of `unit_m`, 0 without a measurement or beyond 65535 counts.
std::vector<std::uint16_t> ToCounts(const DepthFrame& frame, double unit_m);

// T_world_sensor of a level camera that looks at `target` (world frame) from `distance_m` away. It
// looks down by `look_down_deg` (90: straight down); its direction from the target is turned by
// `azimuth_deg` from x.
recognition::Pose LookAt(const Eigen::Vector3d& target, double distance_m, double look_down_deg,
                         double azimuth_deg);

}  // namespace graspdb::rendering
