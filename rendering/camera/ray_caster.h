// Depth images of an ideal pinhole camera; the only user of Embree.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"
#include "rendering/camera/scene.h"

namespace graspdb::rendering {

// One ray a pixel, row by row.
struct IdealFrame {
  int width = 0;
  int height = 0;
  std::vector<float> depth_m;         // along the sensor's z axis; 0: no hit
  std::vector<float> incidence_rad;   // between the ray and the normal, 0 to pi / 2
  std::vector<std::int32_t> surface;  // see scene.h
};

// Casts rays through pixel centres. Thread-safe.
class RayCaster {
 public:
  // INTERNAL when Embree cannot start.
  static absl::StatusOr<RayCaster> Create();

  // `world_sensor` is T_world_sensor; the sensor's x is right, y down, z forward.
  //
  // INVALID_ARGUMENT for a mesh that CheckMesh rejects, a pose that is not finite or intrinsics
  // without pixels or focal length; RESOURCE_EXHAUSTED when Embree has no memory for the scene.
  absl::StatusOr<IdealFrame> Cast(const Scene& scene,
                                  const recognition::CameraIntrinsics& intrinsics,
                                  const recognition::Pose& world_sensor) const;

 private:
  explicit RayCaster(std::shared_ptr<void> device) : device_(std::move(device)) {}

  std::shared_ptr<void> device_;  // an RTCDevice
};

}  // namespace graspdb::rendering
